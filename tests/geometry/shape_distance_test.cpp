// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/geometry.h"

#include "geometry/fcl_shapes.h"
#include "geometry/random_shapes.h"

#include <doctest/doctest.h>

namespace mneme::test {
namespace {

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
}  // namespace mneme::test
