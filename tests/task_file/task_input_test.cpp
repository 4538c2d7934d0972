// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/task_file.h"

#include "task/small_tasks.h"

#include <string>
#include <variant>

namespace mneme::test {
namespace {

TEST_SUITE("unit") {
  std::string stages(const std::string& list) { return "stages: [" + list + "]\n"; }

  TEST_CASE("turns in degrees are refused") {
    const std::string message = load_failure(
        stages("{move: {link: panda_hand, to: {vary: [{turn: z, from: -180, to: 180, count: "
               "9}]}}}"));
    CHECK_MESSAGE(contains(message,
                           "turns from -180 to 180 go beyond a whole turn: expected radians; "
                           "degrees are -3.1416 to 3.1416 rad"),
                  message);
  }

  TEST_CASE("alternatives are the product of turns and shifts") {
    const Task task =
        make_task(kCell + stages("{move: {link: panda_hand, to: {position: [0.5, 0, "
                                 "0.5], vary: [{turn: z, from: 0, to: 1.5707963, "
                                 "count: 2}, {shift: x, from: 0, to: 0.2, count: 3}]}}}"));
    const std::vector<Transform>& poses = task.stages[0].poses.poses;
    REQUIRE(poses.size() == 6);
    CHECK((poses[2].translation - Vec3(0.7, 0, 0.5)).norm() < 1e-6);
    CHECK((poses[5].translation - Vec3(0, 0.7, 0.5)).norm() < 1e-6);
  }

  TEST_CASE("a pose turns in place where shifts come first") {
    const Task task = make_task(
        kCell + stages("{move: {link: panda_hand, to: {vary: [{shift: x, from: 0.5, to: "
                       "0.5, count: 1}, {turn: z, from: 0, to: 1.5707963, count: 2}]}}}"));
    const std::vector<Transform>& poses = task.stages[0].poses.poses;
    REQUIRE(poses.size() == 2);
    CHECK((poses[1].translation - Vec3(0.5, 0, 0)).norm() < 1e-12);
    CHECK((poses[1].rotation.col(0) - Vec3(0, 1, 0)).norm() < 1e-6);
  }

  TEST_CASE("a task file is told from a problem file by its stages") {
    const TemporaryDirectory directory;
    write_file(directory / "task.yaml", kCell + stages("{detach: cup}"));
    write_file(directory / "problem.yaml", kCell + "goal: [0, 0, 0, 0, 0, 0, 0]\n# stages\n");
    CHECK(is_task_file(directory / "task.yaml"));
    CHECK_FALSE(is_task_file(directory / "problem.yaml"));
    CHECK_FALSE(is_task_file(directory / "missing.yaml"));
  }

  TEST_CASE("goals keep the order in which they are listed") {
    const Task task = make_task(
        kCell + stages("{move: {any: [{link: panda_hand, position: [0.5, 0, 0.6], quat_xyzw: "
                       "[1, 0, 0, 0]}, [0, -0.785, 0, -2.356, 0, 1.571, 0.785]]}}"));
    const std::vector<MoveGoal>& goals = task.stages[0].goals;
    REQUIRE(goals.size() == 2);
    CHECK(std::holds_alternative<PoseGoal>(goals[0]));
    CHECK(std::holds_alternative<Configuration>(goals[1]));
  }

  TEST_CASE("a goal in the frame of a link is where the link is at the start of the task") {
    const std::string goal =
        "{link: panda_hand, frame: panda_hand, position: [0, 0, 0.1], quat_xyzw: [0, 0, 0, 1]}";
    const Task task = make_task(
        kCell + stages("{move: [0.3, -0.785, 0, -2.356, 0, 1.571, 0.785]}, {move: " + goal + "}"));
    const auto hand = static_cast<std::size_t>(*task.robot.find_link("panda_hand"));
    const Vec3 expected = task.robot.link_poses(task.start)[hand] * Vec3(0, 0, 0.1);
    const auto check = [&](const Stage& stage) {
      const PoseGoal& read = std::get<PoseGoal>(stage.goals.at(0));
      CHECK(read.frame.empty());
      CHECK((read.pose.translation - expected).norm() < 1e-9);
    };
    check(task.stages[1]);
    const std::string list = "[{move: " + goal + "}]";
    check(require(parse_stages(list, "stages", task.robot, task.start)).at(0));
    CHECK(contains(require_error(parse_stages(list, "stages", task.robot)).message,
                   "the pose of link \"panda_hand\" is unknown: start: there are 0 values"));
  }

  TEST_CASE("an object that is held at the start needs no link in its poses") {
    const std::string held =
        "attached: [{name: part, link: panda_hand, type: box, size: [0.02, 0.02, 0.06], position: "
        "[0, 0, 0.11]}]\n";
    const Task task = make_task(
        kCell + held +
        stages("{move: {to: {object: part, position: [0.5, 0, 0.6], quat_xyzw: [1, 0, 0, 0]}}}"));
    CHECK(task.stages[0].poses.link == "panda_hand");
  }
}

}  // namespace
}  // namespace mneme::test
