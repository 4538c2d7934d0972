// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/scene.h"

#include "geometry/random_shapes.h"
#include "support/support.h"

#include <doctest/doctest.h>

namespace mneme::test {
namespace {

TEST_SUITE("unit") {
  TEST_CASE("a scene is written one shape a line") {
    const Scene scene{"room",
                      {{"ball", {Sphere{{1, 2, 3}, 0.5}}},
                       {"table", {Box{{}, {0.5, 0.5, 0.1}}, Cylinder{{}, 0.1, 1}}}}};
    CHECK(to_yaml(scene) ==
          "name: room\n"
          "obstacles:\n"
          "  - {name: ball, type: sphere, position: [1, 2, 3], radius: 0.5}\n"
          "  - {body: table, type: box, position: [0, 0, 0], size: [1, 1, 0.2]}\n"
          "  - {body: table, type: cylinder, position: [0, 0, 0], radius: 0.1, length: 1}\n");
  }

  TEST_CASE("a scene without obstacles reads back") {
    const auto scene = require(parse_scene(to_yaml(Scene{"", {}}), "f"));
    CHECK(scene.name.empty());
    CHECK(scene.obstacles.empty());
  }
}

/// Points are exact; rotations go through a quaternion.
void check_same(const Shape& read, const Shape& written) {
  REQUIRE(read.index() == written.index());
  if (const auto* sphere = std::get_if<Sphere>(&written)) {
    REQUIRE(std::get<Sphere>(read).center == sphere->center);
    REQUIRE(std::get<Sphere>(read).radius == sphere->radius);
  } else if (const auto* box = std::get_if<Box>(&written)) {
    REQUIRE(std::get<Box>(read).half_extents == box->half_extents);
    REQUIRE(std::get<Box>(read).pose.translation == box->pose.translation);
    REQUIRE((std::get<Box>(read).pose.rotation - box->pose.rotation).norm() < 1e-14);
  } else if (const auto* cylinder = std::get_if<Cylinder>(&written)) {
    REQUIRE(std::get<Cylinder>(read).radius == cylinder->radius);
    REQUIRE(std::get<Cylinder>(read).length == cylinder->length);
    REQUIRE((std::get<Cylinder>(read).pose.rotation - cylinder->pose.rotation).norm() < 1e-14);
  } else if (const auto* capsule = std::get_if<Capsule>(&written)) {
    REQUIRE(std::get<Capsule>(read).a == capsule->a);
    REQUIRE(std::get<Capsule>(read).b == capsule->b);
    REQUIRE(std::get<Capsule>(read).radius == capsule->radius);
  }
}

TEST_SUITE("law") {
  TEST_CASE("a written scene reads back to the same scene") {
    Rng rng(81);
    for (int i = 0; i < 300; ++i) {
      Scene scene{"scene " + std::to_string(i), {}};
      const std::uint32_t obstacles = rng.index(6);
      for (std::uint32_t j = 0; j < obstacles; ++j) {
        Obstacle obstacle{"obstacle: " + std::to_string(j), {}};
        const std::uint32_t shapes = 1 + rng.index(3);
        for (std::uint32_t k = 0; k < shapes; ++k) {
          obstacle.shapes.push_back(random_shape(static_cast<int>(rng.index(kShapeKinds)), rng));
        }
        scene.obstacles.push_back(obstacle);
      }
      INFO("seed 81, case " << i);
      const auto read = require(parse_scene(to_yaml(scene), "f"));
      REQUIRE(read.name == scene.name);
      REQUIRE(read.obstacles.size() == scene.obstacles.size());
      for (std::size_t j = 0; j < obstacles; ++j) {
        REQUIRE(read.obstacles[j].name == scene.obstacles[j].name);
        REQUIRE(read.obstacles[j].shapes.size() == scene.obstacles[j].shapes.size());
        for (std::size_t k = 0; k < scene.obstacles[j].shapes.size(); ++k) {
          check_same(read.obstacles[j].shapes[k], scene.obstacles[j].shapes[k]);
        }
      }
    }
  }
}

const Transform kTurnedPose{rotation_from_rpy({0.1, -0.2, 2.5}), {0.5, -0.25, 1.125}};

FramedScene strange_scene() {
  return {{"a: scene",
           {{"ball", {Sphere{{1, 2, 3}, 0.1}}},
            {"table", {Box{kTurnedPose, {0.1, 0.2, 0.3}}, Cylinder{kTurnedPose, 0.05, 0.7}}}}},
          "base_link"};
}

TEST_SUITE("unit") {
  TEST_CASE("a scene that is written for MoveIt reads back") {
    const TemporaryDirectory directory;
    write_file(directory / "s.yaml", to_moveit_yaml(strange_scene()).value());
    const auto read = require(load_framed_scene(directory / "s.yaml"));
    CHECK(read.frame == "base_link");
    CHECK(read.scene.name == "a: scene");
    REQUIRE(read.scene.obstacles.size() == 2);
    const auto& table = read.scene.obstacles[1];
    CHECK(table.name == "table");
    const auto& box = std::get<Box>(table.shapes.at(0));
    CHECK((box.pose.rotation - kTurnedPose.rotation).norm() < 1e-12);
    CHECK(box.pose.translation == kTurnedPose.translation);
    CHECK(box.half_extents == Vec3(0.1, 0.2, 0.3));
    const auto& can = std::get<Cylinder>(table.shapes.at(1));
    CHECK(can.radius == 0.05);
    CHECK(can.length == 0.7);
    CHECK(std::get<Sphere>(read.scene.obstacles[0].shapes.at(0)).center == Vec3(1, 2, 3));
  }

  TEST_CASE("an empty scene is written, capsules and nameless frames are refused") {
    const TemporaryDirectory directory;
    write_file(directory / "s.yaml", to_moveit_yaml({{"s", {}}, "base"}).value());
    CHECK(load_framed_scene(directory / "s.yaml").value().frame == "");
    CHECK(to_moveit_yaml({{"s", {{"bar", {Capsule{}}}}}, "base"}).error().message ==
          "obstacle \"bar\" has the type capsule; expected spheres, boxes and cylinders alone");
    Scene touching{"s", {{"can", {Sphere{}}}}};
    touching.end_contacts = {{"hand", "can", 0.01}};
    CHECK(contains(require_error(to_moveit_yaml({touching, "base"})).message,
                   "\"hand\" may touch \"can\" at the ends of a path"));
    CHECK(to_moveit_yaml({{"s", {}}, ""}).error().message ==
          "scene \"s\": the frame has no name, which MoveIt needs; name one (--frame)");
  }
}

}  // namespace
}  // namespace mneme::test
