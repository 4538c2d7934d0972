// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/instances.h"
#include "mneme/task.h"

#include "support/support.h"

#include <cstddef>

namespace mneme::test {
namespace {

Robot panda() {
  const auto urdf = find_robot("panda");
  REQUIRE(urdf.has_value());
  auto robot = load_robot(*urdf);
  REQUIRE(robot.has_value());
  return *std::move(robot);
}

TaskInstanceSettings small() {
  TaskInstanceSettings settings;
  settings.grasps = 20;
  settings.placements = 6;
  return settings;
}

TEST_SUITE("law") {
  TEST_CASE("the witness of a task solves it alone, and every stage of its plan is free") {
    const Robot robot = panda();
    for (int i = 0; i < rounds(2); ++i) {
      const auto instance = make_task_instance(robot, small(), static_cast<std::uint64_t>(i));
      REQUIRE_MESSAGE(instance.has_value(), (instance ? "" : instance.error().message));
      Task witness = instance->task;
      for (auto [stage, kept] : {std::pair(std::size_t{1}, instance->grasp),
                                 std::pair(std::size_t{5}, instance->placement)}) {
        std::vector<Transform>& poses = witness.stages[stage].poses.poses;
        poses = std::vector<Transform>{poses.at(static_cast<std::size_t>(kept))};
      }
      const auto plan = solve_task(witness, nullptr);
      REQUIRE(plan.has_value());
      REQUIRE_MESSAGE(plan->is_solved(), plan->message);
      for (const StageResult& stage : plan->stages) {
        CHECK(is_path_free(stage.world->robot, stage.world->scene, stage.path, 0.01,
                           end_tolerances(SolveSettings())));
      }
      const auto whole = solve_task(instance->task, nullptr);
      REQUIRE(whole.has_value());
      CHECK_MESSAGE(whole->is_solved(), whole->message);
    }
  }

  TEST_CASE("the same seed makes the same task") {
    const Robot robot = panda();
    const auto first = make_task_instance(robot, small(), 5);
    const auto second = make_task_instance(robot, small(), 5);
    REQUIRE(first.has_value());
    REQUIRE(second.has_value());
    CHECK(first->grasp == second->grasp);
    CHECK(first->placement == second->placement);
    CHECK(first->task.scene == second->task.scene);
    CHECK(first->task.stages[1].poses.poses == second->task.stages[1].poses.poses);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("a blocked task is refused with the slab's name") {
    TaskInstanceSettings settings = small();
    settings.is_blocked = true;
    const auto instance = make_task_instance(panda(), settings, 1);
    REQUIRE(instance.has_value());
    CHECK(instance->grasp == -1);
    const auto plan = solve_task(instance->task, nullptr);
    REQUIRE(plan.has_value());
    CHECK(plan->status == PlanStatus::invalid_goal);
    CHECK(plan->message.find("'slab'") != std::string::npos);
  }

  TEST_CASE("settings without a task and other robots are refused") {
    TaskInstanceSettings settings = small();
    settings.grasps = 0;
    const auto none = make_task_instance(panda(), settings, 1);
    REQUIRE_FALSE(none.has_value());
    CHECK(none.error().message.find("at least 1 grasp") != std::string::npos);
    const auto planar = make_task_instance(planar8(), small(), 1);
    REQUIRE_FALSE(planar.has_value());
    CHECK(planar.error().message.find("expected the bundled Panda") != std::string::npos);
  }
}

}  // namespace
}  // namespace mneme::test
