// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/moveit_messages.h"
#include "scene/read_yaml.h"

#include <doctest/doctest.h>

namespace mneme::test {
namespace {

using internal::read_moveit_objects;

/// The message for an object "x" with these keys on one line.
std::string failure(const std::string& keys) {
  return failure_of("collision_objects:\n  - {id: x, " + keys + "}", read_moveit_objects);
}

const std::string kPose = "primitive_poses: [{position: [0, 0, 0]}]";

TEST_SUITE("unit") {
  TEST_CASE("the pose of an object carries those of its primitives") {
    const auto objects = read_yaml(R"(
collision_objects:
  - id: table
    header: {frame_id: world}
    pose: {position: [0, 0, 1], orientation: [0, 0, 1, 1]}
    primitives:
      - {type: box, dimensions: [1, 2, 3]}
      - {type: 3, dimensions: [0.5, 0.1]}
      - {type: sphere, dimensions: [0.2]}
    primitive_poses:
      - {position: [1, 0, 0], orientation: [0, 0, 0, 1]}
      - {position: [0, 1, 0], orientation: [0, 0, 0, 1]}
      - {position: [0, 0, 1], orientation: [0, 0, 0, 1]}
    operation: 0
)",
                                   read_moveit_objects)
                             .value();
    REQUIRE(objects.size() == 1);
    CHECK(objects[0].frame == "world");
    CHECK(objects[0].obstacle.name == "table");
    const auto& shapes = objects[0].obstacle.shapes;
    REQUIRE(shapes.size() == 3);
    CHECK((std::get<Box>(shapes[0]).pose.translation - Vec3(0, 1, 1)).norm() < 1e-12);
    CHECK(std::get<Box>(shapes[0]).half_extents == Vec3(0.5, 1, 1.5));
    CHECK((std::get<Cylinder>(shapes[1]).pose.translation - Vec3(-1, 0, 1)).norm() < 1e-12);
    CHECK(std::get<Cylinder>(shapes[1]).length == 0.5);
    CHECK(std::get<Cylinder>(shapes[1]).radius == 0.1);
    CHECK((std::get<Sphere>(shapes[2]).center - Vec3(0, 0, 2)).norm() < 1e-12);
  }

  TEST_CASE("an object with a pose of its own needs none for its primitives") {
    const auto objects = read_yaml(
        "collision_objects: [{id: x, pose: {position: [1, 2, 3]}, primitives: [{type: sphere, "
        "dimensions: [1]}], primitive_poses: []}]",
        read_moveit_objects);
    REQUIRE(objects.has_value());
    CHECK(std::get<Sphere>(objects->at(0).obstacle.shapes.at(0)).center == Vec3(1, 2, 3));
  }

  TEST_CASE("objects that are not boxes, spheres and cylinders are refused by name") {
    CHECK(failure("primitives: [{type: cone, dimensions: [1, 1]}], " + kPose) ==
          "f:2: key collision_objects[0].primitives[0].type: object \"x\" has a cone, which is not "
          "supported; expected box, sphere or cylinder");
    CHECK(failure("meshes: [{vertices: []}]") ==
          "f:2: key collision_objects[0].meshes: object \"x\" has meshes, which are not supported; "
          "expected primitives alone");
    CHECK(failure("planes: [{coef: [0, 0, 1, 0]}]") ==
          "f:2: key collision_objects[0].planes: object \"x\" has planes, which are not supported; "
          "expected primitives alone");
    CHECK(failure("operation: remove") ==
          "f:2: key collision_objects[0].operation: object \"x\": expected the operation add, got "
          "\"remove\"");
    CHECK(failure_of("octomap: {header: {}, octomap: {data: [1, 2]}}", read_moveit_objects) ==
          "f:1: key octomap: expected no octomap: octomaps are not supported");
  }

  TEST_CASE("objects that are malformed are refused with line and key") {
    CHECK(
        failure("primitives: [{type: box, dimensions: [1, 1]}], " + kPose) ==
        "f:2: key collision_objects[0].primitives[0].dimensions: expected 3 numbers (full extents "
        "along x, y, z in metres), got a list of 2");
    CHECK(
        failure("primitives: [{type: sphere, dimensions: [-1]}], " + kPose) ==
        "f:2: key collision_objects[0].primitives[0].dimensions[0]: expected a number above 0, got "
        "-1");
    CHECK(failure("primitives: [{type: cube, dimensions: [1, 1, 1]}], " + kPose) ==
          "f:2: key collision_objects[0].primitives[0].type: expected box, sphere or cylinder, got "
          "\"cube\"");
    CHECK(
        failure("primitives: [{type: sphere, dimensions: [1]}]") ==
        "f:2: key collision_objects[0]: object \"x\": expected one pose per primitive and at least "
        "one primitive, got 1 primitives and 0 poses");
    CHECK(
        failure("primitives: []") ==
        "f:2: key collision_objects[0]: object \"x\": expected one pose per primitive and at least "
        "one primitive, got 0 primitives and 0 poses");
    CHECK(failure("colour: red").find("f:2: key collision_objects[0].colour: unknown key") == 0);
    CHECK(failure_of("collision_objects: [{id: \"\"}]", read_moveit_objects) ==
          "f:1: key collision_objects[0].id: expected a name, got \"\"");
    const std::string ball =
        "{id: x, primitives: [{type: sphere, dimensions: [1]}], " + kPose + "}";
    CHECK(failure_of("collision_objects: [" + ball + ", " + ball + "]", read_moveit_objects) ==
          "f:1: key collision_objects[1]: expected a name of its own, got \"x\" again");
  }
}

}  // namespace
}  // namespace mneme::test
