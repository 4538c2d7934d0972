// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/moveit_scene.h"
#include "scene/read_yaml.h"

#include <doctest/doctest.h>

namespace mneme::test {
namespace {

using internal::Input;
using internal::MoveitFrames;

/// Where the origin of `frame` is in the root link's frame; the robot has the links root and head.
Result<Vec3> origin(const std::string& yaml, const std::string& frame) {
  return read_yaml(yaml, [&](const Input& input) {
    const auto state = input.find("robot_state");
    const MoveitFrames frames(
        input, state ? internal::read_moveit_state(*state) : internal::MoveitState{});
    return frames
        .pose_in_root(frame, input,
                      [](const std::string& name, const Input&) -> std::optional<Transform> {
                        if (name == "root") return Transform{};
                        if (name == "head")
                          return Transform{Eigen::Matrix3d::Identity(), Vec3(0, 0, 1)};
                        return std::nullopt;
                      })
        .translation;
  });
}

const std::string kBase =
    "robot_state: {multi_dof_joint_state: {header: {frame_id: world}, joint_names: [v], "
    "transforms: [{translation: [1, 0, 0], rotation: [0, 0, 0, 1]}]}}\n";
const std::string kCamera =
    "fixed_frame_transforms: [{header: {frame_id: camera}, child_frame_id: world, transform: "
    "{translation: [0, 5, 0], rotation: [0, 0, 0, 1]}}]\n";

TEST_SUITE("unit") {
  TEST_CASE("links are frames whatever the scene says") {
    CHECK(origin("{}", "root").value() == Vec3(0, 0, 0));
    CHECK(origin(kBase + kCamera, "head").value() == Vec3(0, 0, 1));
  }

  TEST_CASE("the planning frame is where the virtual joint poses the robot") {
    CHECK(origin(kBase, "world").value() == Vec3(-1, 0, 0));
    CHECK(origin(kBase, "").value() == Vec3(-1, 0, 0));
    CHECK(origin(kCamera, "world").value() == Vec3(0, 0, 0));
  }

  TEST_CASE("fixed frames are given in the planning frame") {
    CHECK(origin(kBase + kCamera, "camera").value() == Vec3(-1, 5, 0));
  }

  TEST_CASE("a frame that nobody knows is refused") {
    CHECK(
        origin(kBase, "table").error().message ==
        "f:1: expected a frame that is a link of the robot, the planning frame \"world\" or one of "
        "the fixed_frame_transforms, got \"table\"");
    CHECK_FALSE(origin("{}", "").has_value());
    CHECK(origin(kCamera +
                     "robot_state: {multi_dof_joint_state: {header: {frame_id: moon}, joint_names: "
                     "[v], transforms: [{translation: [1, 0, 0]}]}}\n",
                 "world")
              .error()
              .message ==
          "f:1: expected the robot's pose in the planning frame \"world\", got one "
          "in \"moon\"");
  }

  TEST_CASE("fixed frames of two planning frames are refused") {
    CHECK(
        origin(
            "fixed_frame_transforms:\n"
            "  - {child_frame_id: a, header: {frame_id: a}, transform: {translation: [0, 0, 0]}}\n"
            "  - {child_frame_id: b, header: {frame_id: a}, transform: {translation: [0, 0, 0]}}",
            "root")
            .error()
            .message ==
        "f:3: key fixed_frame_transforms[1].child_frame_id: expected the planning "
        "frame \"a\" as in the entries before, got \"b\"");
  }
}

}  // namespace
}  // namespace mneme::test
