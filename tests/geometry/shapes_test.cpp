// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/geometry.h"

#include "geometry/random_shapes.h"

#include <doctest/doctest.h>

#include <numbers>

namespace mneme::test {
namespace {

TEST_SUITE("unit") {
  TEST_CASE("every shape has its name") {
    CHECK(shape_name(Sphere{}) == "sphere");
    CHECK(shape_name(Box{}) == "box");
    CHECK(shape_name(Cylinder{}) == "cylinder");
    CHECK(shape_name(Capsule{}) == "capsule");
  }

  TEST_CASE("bounding spheres are tight") {
    CHECK(bounding_sphere(Sphere{Vec3::UnitX(), 2}).radius == 2);
    CHECK(bounding_sphere(Box{{}, {2, 3, 6}}).radius == doctest::Approx(7));
    CHECK(bounding_sphere(Cylinder{{}, 3, 8}).radius == doctest::Approx(5));
    const Sphere sphere = bounding_sphere(Capsule{Vec3::Zero(), {4, 0, 0}, 0.5});
    CHECK(sphere.radius == doctest::Approx(2.5));
    CHECK((sphere.center - Vec3(2, 0, 0)).norm() < 1e-15);
  }

  TEST_CASE("a capsule moves with both of its ends") {
    const Transform X{rotation_about(Vec3::UnitZ(), std::numbers::pi / 2), {1, 0, 0}};
    const auto moved = std::get<Capsule>(transformed(X, Capsule{{0, 0, 0}, {2, 0, 0}, 0.1}));
    CHECK((moved.a - Vec3(1, 0, 0)).norm() < 1e-15);
    CHECK((moved.b - Vec3(1, 2, 0)).norm() < 1e-15);
    CHECK(moved.radius == 0.1);
  }
}

TEST_SUITE("law") {
  TEST_CASE("points of a shape lie in its bounding sphere, and moving both keeps distances") {
    Rng rng(21);
    for (int i = 0; i < 20000; ++i) {
      const Shape shape = random_shape(i % kShapeKinds, rng);
      const Vec3 p = random_vector(rng, 4.0);
      const Sphere bound = bounding_sphere(shape);
      const double to_shape = distance(p, shape);
      if (to_shape == 0.0) {
        REQUIRE((p - bound.center).norm() <= bound.radius + 1e-12);
      }
      REQUIRE(to_shape >= (p - bound.center).norm() - bound.radius - 1e-12);
      const Transform X = random_pose(rng, 3.0);
      REQUIRE(distance(X * p, transformed(X, shape)) == doctest::Approx(to_shape).epsilon(1e-12));
    }
  }
}

}  // namespace
}  // namespace mneme::test
