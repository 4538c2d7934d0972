// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/geometry.h"

#include "geometry/fcl_shapes.h"
#include "geometry/random_shapes.h"

#include <doctest/doctest.h>

namespace mneme::test {
namespace {

/// Nested ternary searches over both parameters: slow, and unlike the code under test.
double searched_distance(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const auto least = [](const auto& f) {
    double low = 0.0;
    double high = 1.0;
    for (int i = 0; i < 60; ++i) {
      const double third = (high - low) / 3.0;
      if (f(low + third) < f(high - third)) {
        high -= third;
      } else {
        low += third;
      }
    }
    return f(0.5 * (low + high));
  };
  return least([&](double s) {
    const Vec3 p = a + s * (b - a);
    return least([&](double t) { return (p - c - t * (d - c)).norm(); });
  });
}

TEST_SUITE("unit") {
  TEST_CASE("crossing segments touch") {
    CHECK(segment_distance({-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}) == 0);
    CHECK(segment_distance({-1, 0, 0}, {1, 0, 0}, {0, -1, 2}, {0, 1, 2}) == 2);
  }

  TEST_CASE("parallel segments are measured wherever they overlap or end") {
    CHECK(segment_distance({0, 0, 0}, {4, 0, 0}, {1, 1, 0}, {2, 1, 0}) == 1);
    CHECK(segment_distance({0, 0, 0}, {4, 0, 0}, {6, 1, 0}, {-2, 1, 0}) == 1);
    CHECK(segment_distance({0, 0, 0}, {1, 0, 0}, {4, 4, 0}, {9, 4, 0}) == 5);
    CHECK(segment_distance({0, 0, 0}, {1, 0, 0}, {3, 0, 0}, {9, 0, 0}) == 2);
    CHECK(segment_distance({0, 0, 0}, {3, 0, 0}, {1, 0, 0}, {9, 0, 0}) == 0);
  }

  TEST_CASE("either segment may be a point") {
    const Vec3 p(0, 3, 0);
    CHECK(segment_distance(p, p, {-1, 0, 0}, {1, 0, 0}) == 3);
    CHECK(segment_distance({-1, 0, 0}, {1, 0, 0}, p, p) == 3);
    CHECK(segment_distance(p, p, Vec3::Zero(), Vec3::Zero()) == 3);
    CHECK(segment_distance(p, p, p, p) == 0);
  }

  TEST_CASE(
      "nearly parallel segments that cross touch, and those that do not keep their distance") {
    for (const double tilt : {1e-4, 1e-8, 1e-12, 1e-15}) {
      CAPTURE(tilt);
      CHECK(segment_distance({-1, -tilt, 0}, {1, tilt, 0}, {-1, tilt, 0}, {1, -tilt, 0}) < 1e-15);
      CHECK(segment_distance({-1, -tilt, 1}, {1, tilt, 1}, {-1, tilt, 0}, {1, -tilt, 0}) ==
            doctest::Approx(1.0).epsilon(1e-14));
    }
  }
}

TEST_SUITE("law") {
  TEST_CASE("order and direction of the segments do not matter") {
    Rng rng(41);
    for (int i = 0; i < 20000; ++i) {
      const auto [a, b] = random_segment(rng, Vec3::UnitX());
      const auto [c, d] = random_segment(rng, b - a);
      const double expected = segment_distance(a, b, c, d);
      REQUIRE(segment_distance(c, d, a, b) == doctest::Approx(expected).epsilon(1e-12).scale(1));
      REQUIRE(segment_distance(b, a, d, c) == doctest::Approx(expected).epsilon(1e-12).scale(1));
    }
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("segment distances are those of a search over both parameters") {
    Rng rng(42);
    for (int i = 0; i < 1000; ++i) {
      const auto [a, b] = random_segment(rng, Vec3::UnitX());
      const auto [c, d] = random_segment(rng, b - a);
      INFO("seed 42, case " << i);
      const double found = segment_distance(a, b, c, d);
      const double searched = searched_distance(a, b, c, d);
      REQUIRE(found <= searched + 1e-12);
      REQUIRE(found >= searched - 1e-7);
    }
  }

  TEST_CASE("segment distances are those of FCL for thin capsules") {
    Rng rng(43);
    for (int i = 0; i < 5000; ++i) {
      const Vec3 a = random_vector(rng, 3.0);
      const Vec3 b = random_vector(rng, 3.0);
      const Vec3 c = random_vector(rng, 3.0);
      const Vec3 d = random_vector(rng, 3.0);
      INFO("seed 43, case " << i);
      const double expected = fcl_distance(Capsule{a, b, 1e-3}, Capsule{c, d, 1e-3});
      REQUIRE(std::max(0.0, segment_distance(a, b, c, d) - 2e-3) ==
              doctest::Approx(expected).epsilon(1e-9).scale(1));
    }
  }
}

}  // namespace
}  // namespace mneme::test
