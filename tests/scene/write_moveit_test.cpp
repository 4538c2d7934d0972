// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/scene.h"

#include "support/support.h"

namespace mneme::test {
namespace {

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
    const auto read = load_framed_scene(directory / "s.yaml");
    REQUIRE_MESSAGE(read.has_value(), (read ? "" : read.error().message));
    CHECK(read->frame == "base_link");
    CHECK(read->scene.name == "a: scene");
    REQUIRE(read->scene.obstacles.size() == 2);
    const auto& table = read->scene.obstacles[1];
    CHECK(table.name == "table");
    const auto& box = std::get<Box>(table.shapes.at(0));
    CHECK((box.pose.rotation - kTurnedPose.rotation).norm() < 1e-12);
    CHECK(box.pose.translation == kTurnedPose.translation);
    CHECK(box.half_extents == Vec3(0.1, 0.2, 0.3));
    const auto& can = std::get<Cylinder>(table.shapes.at(1));
    CHECK(can.radius == 0.05);
    CHECK(can.length == 0.7);
    CHECK(std::get<Sphere>(read->scene.obstacles[0].shapes.at(0)).center == Vec3(1, 2, 3));
  }

  TEST_CASE("an empty scene is written, capsules and nameless frames are refused") {
    const TemporaryDirectory directory;
    write_file(directory / "s.yaml", to_moveit_yaml({{"s", {}}, "base"}).value());
    CHECK(load_framed_scene(directory / "s.yaml").value().frame == "");
    CHECK(to_moveit_yaml({{"s", {{"bar", {Capsule{}}}}}, "base"}).error().message ==
          "obstacle \"bar\" is a capsule; expected spheres, boxes and cylinders alone, which is "
          "what MoveIt has");
    CHECK(to_moveit_yaml({{"s", {}}, ""}).error().message ==
          "scene \"s\": expected the name of its frame, which MoveIt needs");
  }
}

}  // namespace
}  // namespace mneme::test
