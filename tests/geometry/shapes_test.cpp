// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/geometry.h"

#include "geometry/random_shapes.h"
#include "geometry/solids.h"

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace mneme::test {
namespace {

TEST_SUITE("unit") {
  TEST_CASE("every shape has its name") {
    CHECK(shape_name(Sphere{}) == "sphere");
    CHECK(shape_name(Box{}) == "box");
    CHECK(shape_name(Cylinder{}) == "cylinder");
    CHECK(shape_name(Capsule{}) == "capsule");
    CHECK(shape_name(PointCloud{}) == "points");
    CHECK(shape_name(Mesh{}) == "mesh");
    CHECK(shape_name(Octree{}) == "octree");
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

/// Volume and mean of the points of a solid, by a grid over the cube around it.
internal::Moments grid_moments(const Shape& shape) {
  constexpr int kSteps = 60;
  const Sphere bound = bounding_sphere(shape);
  const double step = 2 * bound.radius / kSteps;
  internal::Moments sum;
  double count = 0;
  for (int i = 0; i < kSteps * kSteps * kSteps; ++i) {
    const Vec3 cell(i % kSteps, i / kSteps % kSteps, i / (kSteps * kSteps));
    const Vec3 p = bound.center + step * (cell + Vec3::Constant(0.5 - 0.5 * kSteps));
    if (distance(p, shape) > 0) continue;
    count += 1;
    sum.centroid += p;
    sum.covariance += (p - bound.center) * (p - bound.center).transpose();
  }
  return {count * step * step * step, sum.centroid / count, sum.covariance / count};
}

TEST_SUITE("unit") {
  TEST_CASE("sizes are full extents, radii and lengths") {
    using Sizes = std::vector<double>;
    CHECK(internal::sizes_of(Sphere{{1, 1, 1}, 2}) == Sizes{2});
    CHECK(internal::sizes_of(Box{{}, {2, 3, 6}}) == Sizes{4, 6, 12});
    CHECK(internal::sizes_of(Cylinder{{}, 3, 8}) == Sizes{3, 8});
    CHECK(internal::sizes_of(Capsule{Vec3::Zero(), {4, 0, 0}, 0.5}) == Sizes{0.5, 4});
  }
}

TEST_SUITE("law") {
  TEST_CASE("a resized shape has these sizes about the same middle") {
    Rng rng(22);
    for (int i = 0; i < 400; ++i) {
      const Shape shape = random_shape(i % kShapeKinds, rng);
      std::vector<double> sizes = internal::sizes_of(shape);
      for (double& size : sizes) size += rng.uniform(0.1, 1);
      const Shape resized = internal::resized(shape, sizes);
      REQUIRE(resized.index() == shape.index());
      const std::vector<double> now = internal::sizes_of(resized);
      for (std::size_t k = 0; k < sizes.size(); ++k) REQUIRE(std::abs(now[k] - sizes[k]) < 1e-12);
      const Vec3 before = bounding_sphere(shape).center, after = bounding_sphere(resized).center;
      REQUIRE((before - after).norm() < 1e-12);
    }
  }

  TEST_CASE("scaling about a point scales all distances from it") {
    Rng rng(23);
    for (int i = 0; i < 400; ++i) {
      const Shape shape = random_shape(i % kShapeKinds, rng);
      const Vec3 about = random_vector(rng, 2), p = random_vector(rng, 4);
      const double factor = rng.uniform(0.2, 3);
      const double scaled =
          distance(about + factor * (p - about), internal::scaled(shape, about, factor));
      REQUIRE(std::abs(scaled - factor * distance(p, shape)) < 1e-9);
    }
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("moments are those of the points of a solid") {
    Rng rng(24);
    for (int i = 0; i < 24; ++i) {
      const Shape shape = random_shape(i % kShapeKinds, rng);
      const internal::Moments moments = internal::moments_of(shape), grid = grid_moments(shape);
      const double size = bounding_sphere(shape).radius;
      INFO("seed 24, case " << i);
      if (grid.volume < 0.1 * size * size * size) continue;  // too thin for the grid
      CHECK(moments.volume == doctest::Approx(grid.volume).epsilon(0.1));
      CHECK((moments.centroid - grid.centroid).norm() < 0.03 * size);
      if (std::holds_alternative<Capsule>(shape)) continue;
      CHECK((moments.covariance - grid.covariance).norm() < 0.1 * moments.covariance.norm());
    }
  }
}

constexpr double kQuarter = std::numbers::pi / 2;

TEST_SUITE("unit") {
  TEST_CASE("a quarter turn about z takes x to y") {
    const Vec3 turned = rotation_about(Vec3::UnitZ(), kQuarter) * Vec3::UnitX();
    CHECK((turned - Vec3::UnitY()).norm() < 1e-15);
  }

  TEST_CASE("roll, pitch and yaw turn about the fixed axes in that order") {
    // Roll takes y to z, pitch then takes z to x, yaw then takes x to y.
    CHECK(
        (rotation_from_rpy({kQuarter, kQuarter, kQuarter}) * Vec3::UnitY() - Vec3::UnitY()).norm() <
        1e-15);
    CHECK((rotation_from_rpy({kQuarter, 0, kQuarter}) * Vec3::UnitY() - Vec3::UnitZ()).norm() <
          1e-15);
    CHECK((rotation_from_rpy({0, kQuarter, kQuarter}) * Vec3::UnitX() + Vec3::UnitZ()).norm() <
          1e-15);
  }

  TEST_CASE("the scalar part of a quaternion comes first") {
    CHECK((rotation_from_quaternion(1, 0, 0, 1) * Vec3::UnitX() - Vec3::UnitY()).norm() < 1e-15);
  }

  TEST_CASE("the length of a quaternion does not matter, however extreme") {
    const Eigen::Matrix3d expected = rotation_from_quaternion(0.5, 0.5, 0.5, 0.5);
    for (const double size : {1e-200, 3.0, 1e200}) {
      CHECK((rotation_from_quaternion(size, size, size, size) - expected).norm() < 1e-14);
    }
  }

  TEST_CASE("a product of transforms applies the right one first") {
    const Transform turn{rotation_about(Vec3::UnitZ(), kQuarter), Vec3::Zero()};
    const Transform shift{Eigen::Matrix3d::Identity(), Vec3::UnitX()};
    CHECK(((turn * shift) * Vec3::Zero() - Vec3::UnitY()).norm() < 1e-15);
    CHECK(((shift * turn) * Vec3::Zero() - Vec3::UnitX()).norm() < 1e-15);
  }
}

TEST_SUITE("law") {
  TEST_CASE("rotations are orthogonal with determinant one") {
    Rng rng(11);
    for (int i = 0; i < 1000; ++i) {
      const Vec3 rpy = random_vector(rng, 10.0);
      for (const Eigen::Matrix3d& r : {rotation_from_rpy(rpy), random_pose(rng, 1.0).rotation}) {
        REQUIRE((r * r.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-13);
        REQUIRE(r.determinant() == doctest::Approx(1.0));
      }
    }
  }

  TEST_CASE("a transform and its inverse cancel") {
    Rng rng(12);
    for (int i = 0; i < 1000; ++i) {
      const Transform X = random_pose(rng, 5.0);
      const Vec3 p = random_vector(rng, 5.0);
      REQUIRE((X.inverse() * (X * p) - p).norm() < 1e-13);
      REQUIRE(((X * X.inverse()) * p - p).norm() < 1e-13);
    }
  }
}

}  // namespace
}  // namespace mneme::test
