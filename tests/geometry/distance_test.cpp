// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/geometry.h"

#include "geometry/fcl_shapes.h"
#include "geometry/random_shapes.h"
#include "geometry/solids.h"
#include "support/support.h"

#include <doctest/doctest.h>

namespace mneme::test {
namespace {

TEST_SUITE("unit") {
  TEST_CASE("a point is measured to the surface, and is at distance 0 inside") {
    CHECK(distance({3, 0, 0}, Sphere{Vec3::Zero(), 1}) == 2);
    CHECK(distance({0.5, 0, 0}, Sphere{Vec3::Zero(), 1}) == 0);
    CHECK(distance({1, 1, 0.5}, Box{{}, {1, 2, 3}}) == 0);
  }

  TEST_CASE("a box is measured to its face, edge or corner") {
    const Box box{{}, {1, 2, 3}};
    CHECK(distance({4, 1, 1}, box) == 3);
    CHECK(distance({4, -6, 1}, box) == 5);
    CHECK(distance({3, 3, 5}, box) == doctest::Approx(3));
  }

  TEST_CASE("a cylinder is measured to its side, flat end or rim") {
    const Cylinder cylinder{{}, 1, 4};
    CHECK(distance({0, 3, 1}, cylinder) == 2);
    CHECK(distance({0.5, 0.5, -5}, cylinder) == 3);
    CHECK(distance({0, 5, 5}, cylinder) == doctest::Approx(5));
    CHECK(distance({0, 0, 2}, cylinder) == 0);
  }

  TEST_CASE("a capsule without length is a sphere") {
    CHECK(distance({3, 0, 0}, Capsule{Vec3::Zero(), Vec3::Zero(), 1}) == 2);
    CHECK(distance({3, 4, 0}, Capsule{Vec3::Zero(), {0, 1e-170, 0}, 1}) == 4);
  }
}

TEST_SUITE("law") {
  TEST_CASE("a distance changes by no more than the point moves") {
    Rng rng(31);
    for (int i = 0; i < 20000; ++i) {
      const Shape shape = random_shape(i % kShapeKinds, rng);
      const Vec3 p = random_vector(rng, 4.0);
      const Vec3 step = random_vector(rng, i % 3 == 0 ? 1e-6 : 1.0);
      REQUIRE(std::abs(distance(p + step, shape) - distance(p, shape)) <= step.norm() + 1e-13);
    }
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("point distances are those of FCL for a small sphere") {
    Rng rng(32);
    constexpr double kRadius = 1e-3;
    for (int i = 0; i < 4000; ++i) {
      const Shape shape = random_shape(i % kShapeKinds, rng);
      const Vec3 p = random_vector(rng, 4.0);
      const double expected = fcl_distance(Sphere{p, kRadius}, shape);
      INFO("seed 32, case " << i << ", " << shape_name(shape));
      REQUIRE(std::max(0.0, distance(p, shape) - kRadius) ==
              doctest::Approx(expected).epsilon(1e-12).scale(1.0));
    }
  }
}

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

Box box_of(const Vec3& center, const Vec3& half_extents) {
  return {{Eigen::Matrix3d::Identity(), center}, half_extents};
}

TEST_SUITE("unit") {
  TEST_CASE("spheres are as far apart as their surfaces, and at 0 where they meet") {
    const Shape ball = Sphere{{1, 0, 0}, 0.5};
    CHECK(distance(ball, Shape(Sphere{{1, 3, 4}, 1})) == doctest::Approx(3.5));
    CHECK(distance(ball, Shape(Sphere{{1.2, 0, 0}, 0.1})) == 0);
    CHECK(distance(ball, ball) == 0);
  }

  TEST_CASE("boxes are measured from face to face, edge to edge and corner to corner") {
    const Shape box = box_of({0, 0, 0}, {1, 1, 1});
    CHECK(distance(box, Shape(box_of({3, 0.5, 0}, {1, 1, 1}))) == doctest::Approx(1));
    CHECK(distance(box, Shape(box_of({5, 6, 0}, {1, 1, 1}))) == doctest::Approx(5));
    CHECK(distance(box, Shape(box_of({4, 4, 3}, {1, 1, 1}))) == doctest::Approx(3));
    CHECK(distance(box, Shape(box_of({2, 0, 0}, {1, 1, 1}))) == 0);
    CHECK(distance(box, Shape(box_of({0.1, 0, 0}, {0.1, 0.1, 0.1}))) == 0);
  }

  TEST_CASE("a thin board and a post on it touch") {
    const Shape board = box_of({0.8, 0, 0.5}, {0.2, 0.4, 0.01});
    const Shape post = Cylinder{{Eigen::Matrix3d::Identity(), {0.8, 0.1, 0.61}}, 0.03, 0.2};
    CHECK(distance(board, post) == 0);
    CHECK(distance(post, board) == 0);
  }

  TEST_CASE("capsules and cylinders are measured to their sides") {
    const Shape capsule = Capsule{{-1, 0, 2}, {1, 0, 2}, 0.25};
    const Shape cylinder = Cylinder{{}, 0.5, 2};
    CHECK(distance(capsule, cylinder) == doctest::Approx(0.75));
    CHECK(distance(Shape(Capsule{{2, -1, 0}, {2, 1, 0}, 0.25}), cylinder) ==
          doctest::Approx(1.25).epsilon(1e-4));
  }
}

TEST_SUITE("law") {
  TEST_CASE("a sphere is as far as its centre, less its radius") {
    Rng rng(61);
    for (int i = 0; i < 4000; ++i) {
      const Shape shape = random_shape(i % kShapeKinds, rng);
      const Sphere ball{random_vector(rng, 3.0), rng.uniform(0.01, 0.5)};
      const double expected = std::max(0.0, distance(ball.center, shape) - ball.radius);
      INFO("seed 61, case " << i << ", " << shape_name(shape));
      REQUIRE(std::abs(distance(Shape(ball), shape) - expected) < 5e-5);
    }
  }

  TEST_CASE("order and a motion of both do not matter") {
    Rng rng(62);
    for (int i = 0; i < 4000; ++i) {
      const Shape a = random_shape(i % kShapeKinds, rng);
      const Shape b = random_shape(static_cast<int>(rng.index(kShapeKinds)), rng);
      const Transform X = random_pose(rng, 2.0);
      const double here = distance(a, b);
      INFO("seed 62, case " << i << ", " << shape_name(a) << " and " << shape_name(b));
      REQUIRE(std::abs(distance(b, a) - here) < 1e-3);
      REQUIRE(std::abs(distance(transformed(X, a), transformed(X, b)) - here) < 1e-3);
    }
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("distances are those of FCL, never less and at most a millimetre more") {
    Rng rng(63);
    double worst = 0;
    int precise = 0, apart = 0;
    for (int i = 0; i < 8000; ++i) {
      const Shape a = random_shape(i % kShapeKinds, rng);
      const Shape b = random_shape(static_cast<int>(rng.index(kShapeKinds)), rng);
      const double expected = fcl_distance(a, b);
      const double error = distance(a, b) - expected;
      INFO("seed 63, case " << i << ", " << shape_name(a) << " and " << shape_name(b));
      REQUIRE(error > -5e-5);  // FCL's own
      REQUIRE(error < 1e-3);
      worst = std::max(worst, error);
      apart += expected > 0 ? 1 : 0;
      precise += error < 5e-5 ? 1 : 0;
    }
    INFO("worst " << worst << ", precise " << precise << ", apart " << apart);
    CHECK(apart > 3000);
    CHECK(precise > 7920);
  }
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("the nearest point of a box is on the face that the point is in front of") {
    const Box box{{Eigen::Matrix3d::Identity(), {1, 2, 3}}, {0.1, 0.2, 0.3}};
    const Vec3 nearest = internal::nearest_point({1.05, 2.1, 9}, box);
    CHECK((nearest - Vec3(1.05, 2.1, 3.3)).norm() < 1e-12);
  }
}

TEST_SUITE("law") {
  TEST_CASE("the nearest point is in the solid, as far away as the distance says") {
    Rng rng(71);
    for (int i = 0; i < 4000; ++i) {
      const Shape shape = random_shape(i % kShapeKinds, rng);
      const Vec3 p = random_vector(rng, 3.0);
      const Vec3 nearest = internal::nearest_point(p, shape);
      REQUIRE(distance(nearest, shape) < 1e-9);
      REQUIRE((p - nearest).norm() == doctest::Approx(distance(p, shape)).epsilon(1e-9));
    }
  }
}

}  // namespace mneme::test
