// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/geometry.h"

#include "geometry/fcl_shapes.h"
#include "geometry/random_shapes.h"

#include <doctest/doctest.h>

namespace mneme::test {
namespace {

/// The least of the distances of many points of the segment, refined about the best of them.
double sampled_distance(const Vec3& a, const Vec3& b, const Shape& shape) {
  constexpr int kSamples = 200;
  const auto at = [&](double t) { return distance(a + t * (b - a), shape); };
  double best = 0.0;
  for (int i = 1; i <= kSamples; ++i) {
    const double t = static_cast<double>(i) / kSamples;
    best = at(t) < at(best) ? t : best;
  }
  double step = 1.0 / kSamples;
  while (step > 1e-13) {
    const double before = std::max(0.0, best - step);
    const double after = std::min(1.0, best + step);
    if (at(before) < at(best)) {
      best = before;
    } else if (at(after) < at(best)) {
      best = after;
    } else {
      step *= 0.5;
    }
  }
  return at(best);
}

TEST_SUITE("unit") {
  TEST_CASE("a segment that passes through a solid is at distance 0, however short the passage") {
    const Vec3 a(-1e3, 0, 0);
    const Vec3 b(1e3, 0, 0);
    CHECK(distance_to_segment(a, b, Sphere{Vec3::Zero(), 1e-3}) == 0);
    CHECK(distance_to_segment(a, b, Box{{}, {1e-3, 1e-3, 1e-3}}) == 0);
    CHECK(distance_to_segment(a, b, Cylinder{{}, 1e-3, 1e-3}) == 0);
    CHECK(distance_to_segment(a, b, Capsule{{0, -1, 0}, {0, 1, 0}, 1e-3}) == 0);
  }

  TEST_CASE("a segment beside a box is measured to the edge that it passes") {
    const Box box{{}, {1, 1, 1}};
    CHECK(distance_to_segment({4, 0, 0}, {0, 4, 0}, box) == doctest::Approx(std::sqrt(2.0)));
    CHECK(distance_to_segment({-5, 2, 0}, {5, 2, 0}, box) == 1);
    CHECK(distance_to_segment({2, -3, 2}, {2, 3, 2}, box) == doctest::Approx(std::sqrt(2.0)));
  }

  TEST_CASE("a segment beside a cylinder is measured to its side, end or rim") {
    const Cylinder cylinder{{}, 1, 2};
    CHECK(distance_to_segment({3, -5, 0}, {3, 5, 0}, cylinder) == doctest::Approx(2));
    CHECK(distance_to_segment({-5, 0, 4}, {5, 0, 4}, cylinder) == doctest::Approx(3));
    CHECK(distance_to_segment({4, 0, 0}, {1, 0, 3}, cylinder) == doctest::Approx(std::sqrt(2.0)));
  }

  TEST_CASE("a segment within a face plane of a box touches it") {
    CHECK(distance_to_segment({-2, 1, 0}, {2, 1, 0}, Box{{}, {1, 1, 1}}) == 0);
    CHECK(distance_to_segment({1, 1, -2}, {1, 1, 2}, Box{{}, {1, 1, 1}}) == 0);
  }
}

TEST_SUITE("law") {
  TEST_CASE("a segment without length has the distance of its point") {
    Rng rng(51);
    for (int i = 0; i < 8000; ++i) {
      const Shape shape = random_shape(i % kShapeKinds, rng);
      const Vec3 p = random_vector(rng, 4.0);
      REQUIRE(distance_to_segment(p, p, shape) ==
              doctest::Approx(distance(p, shape)).epsilon(1e-14));
    }
  }

  TEST_CASE("direction of the segment and motion of everything do not matter") {
    Rng rng(52);
    for (int i = 0; i < 8000; ++i) {
      const Shape shape = random_shape(i % kShapeKinds, rng);
      const auto [a, b] = random_segment(rng, axis_of(shape));
      const Transform X = random_pose(rng, 2.0);
      const double expected = distance_to_segment(a, b, shape);
      INFO("seed 52, case " << i << ", " << shape_name(shape));
      REQUIRE(std::abs(distance_to_segment(b, a, shape) - expected) < 1e-12);
      REQUIRE(std::abs(distance_to_segment(X * a, X * b, transformed(X, shape)) - expected) <
              1e-12);
    }
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("segment distances are the least of those of the segment's points") {
    Rng rng(53);
    for (int i = 0; i < 8000; ++i) {
      const Shape shape = random_shape(i % kShapeKinds, rng);
      const auto [a, b] = random_segment(rng, axis_of(shape));
      INFO("seed 53, case " << i << ", " << shape_name(shape));
      const double found = distance_to_segment(a, b, shape);
      const double sampled = sampled_distance(a, b, shape);
      REQUIRE(found <= sampled + 1e-12);
      REQUIRE(found >= sampled - 1e-9);
    }
  }

  TEST_CASE("segment distances are those of FCL for a thin capsule") {
    Rng rng(54);
    constexpr double kRadius = 1e-3;
    for (int i = 0; i < 4000; ++i) {
      const Shape shape = random_shape(i % kShapeKinds, rng);
      const Vec3 a = random_vector(rng, 3.0);
      const Vec3 b = random_vector(rng, 3.0);
      const double expected = fcl_distance(Capsule{a, b, kRadius}, shape);
      INFO("seed 54, case " << i << ", " << shape_name(shape));
      REQUIRE(std::abs(std::max(0.0, distance_to_segment(a, b, shape) - kRadius) - expected) <
              1e-5);
    }
  }
}

}  // namespace
}  // namespace mneme::test
