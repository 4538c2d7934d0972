// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/geometry.h"

#include "geometry/fcl_shapes.h"
#include "geometry/random_shapes.h"

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

}  // namespace
}  // namespace mneme::test
