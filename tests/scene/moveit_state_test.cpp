// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/moveit_messages.h"
#include "scene/read_yaml.h"

#include <doctest/doctest.h>

namespace mneme::test {
namespace {

using internal::MoveitState;
using internal::read_moveit_state;

TEST_SUITE("unit") {
  TEST_CASE("positions are read by joint, and the virtual joint poses the root link") {
    const MoveitState state = read_yaml(R"(
joint_state: {header: {frame_id: /world}, name: [a, b], position: [1, -2], velocity: [], effort: []}
multi_dof_joint_state:
  header: {frame_id: /world}
  joint_names: [virtual_joint]
  transforms: [{translation: [1, 2, 3], rotation: [0, 0, 0, 1]}]
is_diff: false
attached_collision_objects: []
)",
                                        read_moveit_state)
                                  .value();
    CHECK(state.positions == std::map<std::string, double>{{"a", 1}, {"b", -2}});
    REQUIRE(state.base);
    CHECK(state.base->translation == Vec3(1, 2, 3));
    CHECK(state.base_frame == "world");
  }

  TEST_CASE("what a difference says stands for what was there") {
    MoveitState state;
    state.positions = {{"a", 1}, {"b", 2}};
    state.base = Transform{};
    MoveitState difference;
    difference.positions = {{"b", 3}};
    const MoveitState both = internal::overlaid(state, difference);
    CHECK(both.positions == std::map<std::string, double>{{"a", 1}, {"b", 3}});
    CHECK(both.base);
  }

  TEST_CASE("states that are malformed or carry objects are refused") {
    const auto failure = [](const std::string& yaml) {
      return failure_of(yaml, read_moveit_state);
    };
    CHECK(failure("joint_state: {name: [a, b], position: [1]}") ==
          "f:1: key joint_state: expected one position per name, got 2 names and 1 positions");
    CHECK(failure("joint_state: {name: [a, a], position: [1, 1]}") ==
          "f:1: key joint_state.name[1]: expected each joint once, got a again");
    CHECK(failure("joint_state: {name: [a], position: [.inf]}") ==
          "f:1: key joint_state.position[0]: expected a finite number, got .inf");
    CHECK(
        failure("multi_dof_joint_state: {joint_names: [a, b], transforms: [{}, {}]}") ==
        "f:1: key multi_dof_joint_state: expected one virtual joint that carries the robot's root "
        "link, got 2 names and 2 transforms");
    CHECK(failure("attached_collision_objects:\n  - {link_name: hand, object: {id: cup}}") ==
          "f:2: key attached_collision_objects[0]: object \"cup\" is attached to link \"hand\"; "
          "expected no attached objects: they are not supported");
    CHECK(failure("joints: [1]") ==
          "f:1: key joints: unknown key, expected one of joint_state, multi_dof_joint_state, "
          "attached_collision_objects, is_diff");
  }
}

}  // namespace
}  // namespace mneme::test
