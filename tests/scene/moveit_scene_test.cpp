// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/moveit_scene.h"
#include "scene/read_yaml.h"

#include <doctest/doctest.h>

namespace mneme::test {
namespace {

using internal::Input;

std::string ball(const std::string& name, const std::string& frame) {
  return "{id: " + name + ", header: {frame_id: " + frame +
         "}, primitives: [{type: sphere, dimensions: [0.1]}], primitive_poses: [{position: [1, 0, "
         "0]}]}";
}

std::string world(const std::string& objects) {
  return "world: {collision_objects: [" + objects + "]}\n";
}

internal::MoveitScene read(const Input& input) { return internal::read_moveit_scene(input, "f"); }

Result<FramedScene> place(const std::string& yaml) {
  return parse_scene(yaml, "f.yaml").and_then([&](const Scene&) {
    return read_yaml(yaml, [](const Input& input) {
      const internal::MoveitScene scene = read(input);
      return internal::place_objects(scene, internal::MoveitFrames(input, scene.state));
    });
  });
}

TEST_SUITE("unit") {
  TEST_CASE("planning scenes are told from mneme's own by their keys") {
    const auto is_moveit = [](const std::string& yaml) {
      return read_yaml(yaml, internal::is_moveit_scene).value();
    };
    CHECK(is_moveit("world: {}"));
    CHECK(is_moveit("robot_state: {}"));
    CHECK_FALSE(is_moveit("obstacles: []"));
    CHECK_FALSE(is_moveit("[world]"));
  }

  TEST_CASE("what does not change the obstacles is read over") {
    const auto scene = read_yaml(
        "name: \"\"\nrobot_model_name: fetch\nobject_colors: [{id: a}]\nlink_padding: [{link_name: "
        "hand, padding: 0}]\nlink_scale: [{link_name: hand, scale: 1.0}]\nis_diff: true\n" +
            world(ball("a", "base")),
        read);
    REQUIRE_MESSAGE(scene.has_value(), (scene ? "" : scene.error().message));
    CHECK(scene->name == "f");
    CHECK(scene->robot_name == "fetch");
    CHECK(scene->objects.size() == 1);
    REQUIRE(scene->warnings.size() == 1);
    CHECK(
        scene->warnings[0] ==
        "f:6: key is_diff: this is the difference to a scene that is not given; it is read as the "
        "whole scene");
  }

  TEST_CASE("links that are padded or scaled are refused by name") {
    CHECK(
        failure_of("link_padding: [{link_name: hand, padding: 0.02}]", read) ==
        "f:1: key link_padding[0]: link \"hand\" has the padding 0.02; expected 0: others are not "
        "supported");
    CHECK(failure_of("link_scale: [{link_name: hand, scale: 1.1}]", read) ==
          "f:1: key link_scale[0]: link \"hand\" has the scale 1.1; expected 1: others are not "
          "supported");
    CHECK(failure_of("worlds: {}", read).find("f:1: key worlds: unknown key, expected one of ") ==
          0);
    CHECK(failure_of("is_diff: maybe", read) ==
          "f:1: key is_diff: expected true or false, got \"maybe\"");
  }

  TEST_CASE("without a robot all objects share a frame, which is named") {
    const FramedScene scene = place(world(ball("a", "base") + ", " + ball("b", "base"))).value();
    CHECK(scene.frame == "base");
    CHECK(scene.scene.obstacles.size() == 2);
    CHECK(place(world(ball("a", "base") + ", " + ball("b", "tool")))
              .error()
              .message.find("object \"b\" is given in frame \"tool\", others in \"base\"") !=
          std::string::npos);
  }

  TEST_CASE("without a robot the virtual joint still says where the root link is") {
    const FramedScene scene =
        place(
            "robot_state: {multi_dof_joint_state: {header: {frame_id: world}, joint_names: [v], "
            "transforms: [{translation: [0, 0, 2]}]}}\n" +
            world(ball("a", "world")))
            .value();
    CHECK(scene.frame.empty());
    CHECK(std::get<Sphere>(scene.scene.obstacles.at(0).shapes.at(0)).center == Vec3(1, 0, -2));
  }
}

}  // namespace
}  // namespace mneme::test
