// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "collision/make_tables.h"
#include "collision/random_worlds.h"

#include <Eigen/Geometry>

#include <cmath>
#include <string>

namespace mneme::test {
namespace {

using internal::ObstacleKind;
using internal::SceneTables;

SceneTables require_tables(const Scene& scene) {
  auto tables = internal::make_scene_tables(scene);
  REQUIRE_MESSAGE(tables.has_value(), (tables ? "" : tables.error().message));
  return *tables;
}

Vec3 row_of(const float* p) { return {p[0], p[1], p[2]}; }

Eigen::Matrix3d turn_of(const float* r) {
  Eigen::Matrix3d m;
  for (int i = 0; i < 9; ++i) m(i / 3, i % 3) = r[i];
  return m;
}

Scene scene_of(const std::vector<Shape>& shapes) { return {"s", {{"thing", shapes}}}; }

/// Boxes that are turned by `angle` about z, and one that is turned about x as well.
std::vector<Shape> turned_boxes(double angle) {
  const Eigen::Matrix3d turn = rotation_about(Vec3::UnitZ(), angle);
  const Eigen::Matrix3d odd = rotation_about(Vec3::UnitX(), 0.3);
  return {Box{{turn, {1, 0, 0}}, {0.1, 0.2, 0.3}},
          Box{{turn * rotation_about(Vec3::UnitZ(), kPi / 2), {0, 1, 0}}, {0.1, 0.2, 0.3}},
          Box{{turn * odd, {0, 0, 1}}, {0.1, 0.2, 0.3}}};
}

TEST_SUITE("unit") {
  TEST_CASE("obstacles become rows of their kind, composite ones several") {
    const Transform X{rotation_about(Vec3::UnitY(), kPi / 2), {1, 2, 3}};
    const Scene scene{"s",
                      {{"a", {Sphere{{1, 2, 3}, 0.5}, Box{X, {1, 2, 4}}}},
                       {"b", {Capsule{{0, 0, 0}, {1, 1, 1}, 0.25}, Cylinder{X, 0.5, 3}}},
                       {"c", {Cylinder{{}, 0.5, 3}}}}};
    const SceneTables tables = require_tables(scene);
    REQUIRE(tables.obstacles.size() == 5);
    CHECK(tables.obstacles[0].kind == ObstacleKind::sphere);
    CHECK(row_of(tables.obstacles[0].center) == Vec3(1, 2, 3));
    CHECK(tables.obstacles[0].rounding == 0.5f);
    CHECK(tables.obstacles[1].kind == ObstacleKind::aligned_box);
    CHECK(row_of(tables.obstacles[1].half_extents).isApprox(Vec3(4, 2, 1), 1e-6));
    CHECK(tables.obstacles[2].kind == ObstacleKind::capsule);
    CHECK(row_of(tables.obstacles[2].along) == Vec3(1, 1, 1));
    CHECK(tables.obstacles[2].rounding == 0.25f);
    CHECK(tables.obstacles[3].kind == ObstacleKind::cylinder);
    CHECK(row_of(tables.obstacles[3].half_extents) == Vec3(0.5, 0.5, 1.5));
    CHECK(turn_of(tables.obstacles[3].rotation).isApprox(X.rotation.transpose(), 1e-6));
    CHECK(tables.obstacles[4].kind == ObstacleKind::upright_cylinder);
    CHECK(tables.obstacles[4].rounding == 0);
  }

  TEST_CASE("the scene's axes are those of most boxes") {
    for (const double angle : {0.4, kPi / 4, 2.0}) {
      const SceneTables tables = require_tables(scene_of(turned_boxes(angle)));
      const Eigen::Matrix3d turn = rotation_about(Vec3::UnitZ(), angle);
      CHECK(tables.obstacles[0].kind == ObstacleKind::aligned_box);
      CHECK(tables.obstacles[1].kind == ObstacleKind::aligned_box);
      CHECK(tables.obstacles[2].kind == ObstacleKind::box);
      CHECK(row_of(tables.obstacles[0].center)
                .isApprox(turn_of(tables.rotation) * Vec3(1, 0, 0), 1e-6));
      const Eigen::Matrix3d in_scene = turn_of(tables.rotation) * turn;
      CHECK(in_scene.cwiseAbs().rowwise().maxCoeff().isApprox(Vec3::Ones(), 1e-6));
    }
  }

  TEST_CASE("the robot's own axes are those of a scene without boxes, or of one that has them") {
    auto shapes = turned_boxes(0);
    CHECK(turn_of(require_tables(scene_of(shapes)).rotation).isIdentity());
    shapes = {Cylinder{{rotation_about(Vec3::UnitX(), 0.3), {1, 0, 0}}, 0.1, 0.2}};
    CHECK(turn_of(require_tables(scene_of(shapes)).rotation).isIdentity());
    CHECK(turn_of(require_tables({}).rotation).isIdentity());
  }

  TEST_CASE("bounds fill whole blocks, the rest of which nothing overlaps") {
    for (const std::size_t count : {1, 16, 17}) {
      const std::vector<Shape> shapes(count, Sphere{{1, 2, 3}, 0.5});
      const SceneTables tables = require_tables(scene_of(shapes));
      for (std::size_t axis = 0; axis < 3; ++axis) {
        REQUIRE(tables.lower[axis].size() == (count == 17 ? 32 : 16));
        REQUIRE(tables.upper[axis].size() == tables.lower[axis].size());
        for (std::size_t i = count; i < tables.lower[axis].size(); ++i) {
          CHECK(tables.lower[axis][i] > 1e30f);
          CHECK(tables.upper[axis][i] < -1e30f);
        }
      }
    }
    CHECK(require_tables({}).lower[0].empty());
  }

  TEST_CASE("an obstacle without shapes is an error that names it") {
    const auto tables = internal::make_scene_tables({"s", {{"ghost", {}}}});
    REQUIRE(!tables.has_value());
    CHECK(tables.error().message.find("'ghost'") != std::string::npos);
  }
}

TEST_SUITE("law") {
  TEST_CASE("the bounds of an obstacle contain it, and touch it") {
    Rng rng(511);
    for (int i = 0; i < 400; ++i) {
      std::vector<Shape> shapes = turned_boxes(rng.uniform(-kPi, kPi));
      shapes.push_back(random_shape(i % kShapeKinds, rng));
      const SceneTables tables = require_tables(scene_of(shapes));
      // The rotation of floats is not orthogonal enough for so long a view.
      const Eigen::Quaterniond turn(turn_of(tables.rotation));
      const Transform X_SW{turn.normalized().toRotationMatrix(), Vec3::Zero()};
      const Shape shape = transformed(X_SW, shapes.back());
      const auto bound = [&](const auto& bounds, int axis) {
        return static_cast<double>(bounds[static_cast<std::size_t>(axis)].at(shapes.size() - 1));
      };
      INFO("seed 511, shape " << i);
      for (int axis = 0; axis < 3; ++axis) {
        for (const double side : {-1.0, 1.0}) {
          const double at = side > 0 ? bound(tables.upper, axis) : bound(tables.lower, axis);
          // Seen from so far away, the shape ends in a plane.
          constexpr double kFar = 1e5;
          Vec3 eye = bounding_sphere(shape).center;
          const double reach = side * (at - eye[axis]);
          eye[axis] += side * kFar;
          REQUIRE(distance(eye, shape) > kFar - reach);
          REQUIRE(distance(eye, shape) < kFar - reach + 1e-3);
        }
      }
    }
  }
}

}  // namespace
}  // namespace mneme::test
