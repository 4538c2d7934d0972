// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "task/small_tasks.h"

#include <string>

namespace mneme::test {
namespace {

TEST_SUITE("unit") {
  std::string stages(const std::string& list) { return "stages: [" + list + "]\n"; }

  void fails(const std::string& list, const std::string& expected) {
    const std::string message = load_failure(stages(list));
    INFO(message);
    CHECK(contains(message, expected));
  }

  TEST_CASE("tasks that cannot be meant are refused with the stage and the way out") {
    fails("", "has no stages; expected at least one");
    fails("{name: go, move: next}", "stage 'go': it has no goal, and no line with poses");
    fails("{line: {link: panda_hand}}", "stage 'line 1': the line leads nowhere");
    fails("{line: {link: panda_hnd, direction: [0, 0, 1], distance: 0.1}}",
          "expected a link of robot panda as the link of a line, got 'panda_hnd'; did you mean "
          "'panda_hand'?");
    fails("{move: {link: panda_hand, to: {frame: cop}}}",
          "expected a link or an obstacle as frame, got 'cop'; did you mean 'cup'?");
    fails("{attach: cop}",
          "expected an obstacle of the scene to attach, got 'cop'; did you mean 'cup'");
    fails("{attach: cup}, {attach: cup}", "stage 'attach 2': object 'cup' is held by link");
    fails("{detach: cup}", "expected a held object to detach, got 'cup'; held is nothing");
    fails("{move: {link: panda_hand, to: {object: cup}}}",
          "expected a held object, got 'cup'; an attach stage must come first");
    fails("{gripper: {panda_finger_joint9: 0.01}}", "panda_finger_joint9");
    fails("{gripper: {panda_finger_joint1: 0.01}}",
          "joint 'panda_finger_joint1' is fixed; the movable joints are: panda_joint1, ");
    fails(
        "{name: down, line: {direction: [0, 0, 1], distance: 0.1}, constraints: [{link: "
        "panda_hand, "
        "axis: [0, 0, -1], angle: 0.2}]}",
        "stage 'down': constraints hold in moves only, not in a stage of kind line; remove them");
    fails("{attach: cup, constraints: [{link: panda_hand, axis: [0, 0, -1], angle: 0.2}]}",
          "constraints hold in moves only, not in a stage of kind attach");
    fails("{allow: [{pair: [panda_hand, table], at_ends: 0.01}]}",
          "a stage allows contact until the end of the task: expected a list of two names, as in "
          "[hand, table]; contact at ends belongs to the key 'allow' of the task");
    fails("{allow: [{pair: [panda_hand, table]}]}", "expected a list of two names");
    fails("{allow: [[table, cup]]}", "expected a pair of an obstacle and a link or held object");
    fails("{move: [0, 0, 0]}", "there are 3 values, but robot 'panda' has 7 joints");
    fails("{speed: 2, move: [0, -0.785, 0, -2.356, 0, 1.571, 0.785]}", "its speed is 2");
    fails("{move: {link: panda_hand, to: {position: [0, 0, 0.5], poses: [{position: [0, 0, 1]}]}}}",
          "instead of them");
    fails("{move: next, line: {}}", "expected one kind of stage, got move and line");
    fails("{move: {any: []}}, {line: {direction: [0, 0, 1], distance: 0.1, to: {frame: cup}}}",
          "key stages[0].move.any: expected at least one goal, or move: next");
    fails("{move: {link: panda_hand, to: {frame: cup, quat_xyzw: [0, 2, 0, 0]}}}",
          "expected a quaternion of length 1, got one of length 2");
    fails(
        "{move: [0, 0, 0, -1, 0, 1, 0]}, {name: in, line: {direction: [0, 0, 1], distance: 0.1, "
        "to: {frame: cup}}}",
        "stage 'in': the line begins where the stage before ends, so that its direction and "
        "distance have no effect; remove them, or put 'move: next' before it");
    fails("{name: nothing}", "expected one of the keys move, line, attach");
    fails(
        "{name: a, move: next}, {name: b, attach: cup}, {line: {direction: [0, 0, 1], distance: "
        "0.1, to: {frame: table}}}",
        "stage 'b': it stands between a move without a goal and the line");
  }

  TEST_CASE("goals and states that a robot does not have are refused") {
    fails("{move: {any: [[0, 3, 0, -2, 0, 1, 0], [0, 0, 0, -2, 0, 9, 0]]}}",
          "stage 'move 1': its goal: joint 'panda_joint2' (value 2 of 7) is 3, outside its limits");
    fails("{move: {any: [[0, -0.785, 0, -2.356, 0, 1.571, 0.785], [0, 0]]}}", "there are 2 values");
    fails("{gripper: open}",
          "expected values by joint, or a state that the SRDF of robot panda names for joints "
          "outside of the planning group (it names none), got \"open\"");
    fails("{gripper: 0.02}", "expected values by joint, or the name of a state");
  }

  TEST_CASE("the number of stages is limited") {
    Task task = require(try_task(kCell + stages("{allow: [[panda_hand, table]]}")));
    task.stages.resize(1000, task.stages.front());
    CHECK(check_task(task).has_value());
    task.stages.push_back(task.stages.front());
    CHECK(contains(require_error(check_task(task)).message,
                   "has 1001 stages, expected at most 1000; plan it as several tasks"));
  }

  TEST_CASE("contact of a name that a link and an obstacle share is refused") {
    Task task = require(try_task(kCell + stages("{allow: [[panda_hand, table]]}")));
    task.scene.obstacles[1].name = "panda_link6";
    CHECK(check_task(task).has_value());
    task.stages[0].pairs = {{"panda_link6", "table"}};
    CHECK(contains(require_error(check_task(task)).message,
                   "'panda_link6' is a link and an obstacle; rename the obstacle"));
  }

  TEST_CASE("constraints of the whole task are checked, too") {
    Task task = require(try_task(kCell + stages("{line: {direction: [0, 0, 1], distance: 0.1}}")));
    REQUIRE(check_task(task).has_value());
    task.constraints.push_back({.link = "nope", .angle = 0.2});
    CHECK(contains(require_error(check_task(task)).message, "nope"));
  }

  TEST_CASE("an obstacle with the name of a link cannot be attached") {
    const Error error = require_error(try_task(replaced(kCell, "name: cup", "name: panda_link3") +
                                               stages("{attach: panda_link3}")));
    CHECK(contains(error.message,
                   "object 'panda_link3' has the name of a link: rename the obstacle"));
  }

  TEST_CASE("a message quotes begin and end of a long name") {
    const std::string name(100'000, 'x');
    const std::string message = load_failure(stages("{detach: " + name + "}"));
    CHECK(contains(message, "expected a held object to detach, got 'xxx"));
    CHECK(contains(message, "xxx'; held is nothing"));
    CHECK(message.size() < 5000);
  }
}

}  // namespace
}  // namespace mneme::test
