// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/scene_input.h"
#include "scene/yaml.h"

#include <doctest/doctest.h>

namespace mneme::test {
namespace {

const std::string kObstacleSource = "f";

using internal::ObstacleSpelling;

Result<Scene> read(const std::string& yaml,
                   const ObstacleSpelling& spelling = internal::kSceneSpelling) {
  return internal::without_throwing([&] {
    const auto value = internal::parse_yaml(yaml, "f");
    internal::SceneBuilder builder;
    internal::read_obstacles(internal::Input(value, kObstacleSource), spelling, builder);
    return builder.take("");
  });
}

Shape read_shape(const std::string& yaml) {
  const auto scene = read("- {name: x, " + yaml + "}");
  REQUIRE_MESSAGE(scene.has_value(), (scene ? "" : scene.error().message));
  return scene->obstacles.at(0).shapes.at(0);
}

TEST_SUITE("unit") {
  TEST_CASE("sizes of a box are full extents") {
    const auto box = std::get<Box>(read_shape("type: box, position: [1, 2, 3], size: [2, 4, 6]"));
    CHECK(box.half_extents == Vec3(1, 2, 3));
    CHECK(box.pose.translation == Vec3(1, 2, 3));
    CHECK(box.pose.rotation == Eigen::Matrix3d::Identity());
  }

  TEST_CASE("spheres and cylinders keep their sizes") {
    const auto sphere =
        std::get<Sphere>(read_shape("type: sphere, position: [1, 2, 3], radius: 4"));
    CHECK(sphere.center == Vec3(1, 2, 3));
    CHECK(sphere.radius == 4);
    const auto cylinder =
        std::get<Cylinder>(read_shape("type: cylinder, position: [1, 2, 3], radius: 4, length: 5"));
    CHECK(cylinder.radius == 4);
    CHECK(cylinder.length == 5);
  }

  TEST_CASE("a capsule is given by its pose and length or by its ends") {
    const std::string pose = "type: capsule, position: [1, 0, 0], quat_xyzw: [0, 2, 0, 2], ";
    const auto posed = std::get<Capsule>(read_shape(pose + "radius: 0.1, length: 4"));
    CHECK((posed.a - Vec3(-1, 0, 0)).norm() < 1e-15);
    CHECK((posed.b - Vec3(3, 0, 0)).norm() < 1e-15);
    const auto ends =
        std::get<Capsule>(read_shape("type: capsule, a: [0, 1, 2], b: [3, 4, 5], radius: 0.1"));
    CHECK(ends.a == Vec3(0, 1, 2));
    CHECK(ends.b == Vec3(3, 4, 5));
  }

  TEST_CASE("the spelling decides the order of a quaternion") {
    const auto compact =
        read("- {name: x, type: box, p: [0, 0, 0], q: [1, 0, 0, 1], size: [1, 1, 1]}",
             internal::kCompactSpelling);
    REQUIRE(compact.has_value());
    const auto box = std::get<Box>(compact->obstacles[0].shapes[0]);
    CHECK((box.pose.rotation * Vec3::UnitX() - Vec3::UnitY()).norm() < 1e-15);
    const auto scene = std::get<Box>(
        read_shape("type: box, position: [0, 0, 0], quat_xyzw: [0, 0, 1, 1], size: [1, 1, 1]"));
    CHECK((scene.pose.rotation - box.pose.rotation).norm() < 1e-15);
  }

  TEST_CASE("obstacles that are malformed are refused with key and expectation") {
    const auto refused = [](const std::string& yaml) {
      const auto scene = read("- " + yaml);
      return scene ? std::string() : scene.error().message;
    };
    const std::string sphere = "{name: x, type: sphere, ";
    const std::string box = "{name: x, type: box, position: [0, 0, 0], ";
    CHECK(refused("7") == "f:1: key [0]: expected a map, got 7");
    CHECK(refused("{name: x}") == "f:1: key [0]: expected the key type, which is missing");
    CHECK(refused("{name: x, type: cone}") ==
          "f:1: key [0].type: expected sphere, box, cylinder or capsule, got \"cone\"");
    CHECK(refused(sphere + "radius: 1}") ==
          "f:1: key [0]: expected the key position, which is missing");
    CHECK(refused(sphere + "position: [0, 0], radius: 1}") ==
          "f:1: key [0].position: expected 3 numbers (x, y, z in metres), got a list of 2");
    CHECK(refused(sphere + "position: [0, .nan, 0], radius: 1}") ==
          "f:1: key [0].position[1]: expected a finite number, got .nan");
    CHECK(refused(sphere + "position: [0, 0, 0], radius: -1}") ==
          "f:1: key [0].radius: expected a number above 0, got -1");
    CHECK(refused(sphere + "position: [0, 0, 0], radius: .inf}") ==
          "f:1: key [0].radius: expected a finite number, got .inf");
    CHECK(
        refused(sphere + "position: [0, 0, 0], radius: 1, length: 2}") ==
        "f:1: key [0].length: unknown key, expected one of name, body, type, position, quat_xyzw, "
        "radius");
    CHECK(refused(box + "size: [1, 0, 1]}") ==
          "f:1: key [0].size[1]: expected a number above 0, got 0");
    CHECK(refused(box + "size: 1}") ==
          "f:1: key [0].size: expected 3 numbers (full extents in metres), got 1");
    CHECK(refused(box + "quat_xyzw: [0, 0, 0, 0], size: [1, 1, 1]}") ==
          "f:1: key [0].quat_xyzw: expected a quaternion that is not zero");
    CHECK(refused(box + "quat_xyzw: [0, 0, 1], size: [1, 1, 1]}") ==
          "f:1: key [0].quat_xyzw: expected 4 numbers (a quaternion x, y, z, w), got a list of 3");
    CHECK(refused("{type: sphere, position: [0, 0, 0], radius: 1}") ==
          "f:1: key [0]: expected a name");
    CHECK(refused("{name: '', type: sphere, position: [0, 0, 0], radius: 1}") ==
          "f:1: key [0].name: expected a name, got \"\"");
    CHECK(refused("{name: x, type: capsule, a: [0, 0, 0], radius: 1}") ==
          "f:1: key [0]: expected the key b, which is missing");
  }

  TEST_CASE("circles lie in the plane z = 0, named by a map or numbered in a list") {
    const auto value = internal::parse_yaml("[{a: [1, 2, 3]}, [[4, 5, 6]]]", "f");
    const auto both = internal::Input(value, kObstacleSource).items();
    internal::SceneBuilder builder;
    internal::read_circles(both[0], builder);
    internal::read_circles(both[1], builder);
    const Scene scene = builder.take("");
    REQUIRE(scene.obstacles.size() == 2);
    CHECK(scene.obstacles[0].name == "a");
    CHECK(scene.obstacles[1].name == "circle_1");
    const auto sphere = std::get<Sphere>(scene.obstacles[1].shapes[0]);
    CHECK(sphere.center == Vec3(4, 5, 0));
    CHECK(sphere.radius == 6);
  }
}

}  // namespace
}  // namespace mneme::test
