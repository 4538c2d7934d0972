// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ompl/small_problems.h"
#include "planning/planner_flow.h"

namespace mneme::test {
namespace {

Problem problem_of(const World& world) {
  return {world.name, world.robot, "", world.scene, world.query.start, world.query.goals, {}};
}

Path solved_path(const World& world, const SolveSettings& settings) {
  const SolveResult result = require_solved(problem_of(world), nullptr, settings);
  return result.plan.path;
}

}  // namespace

TEST_SUITE("flow") {
  TEST_CASE("what OMPL's planners find is verified between the states if that is asked for") {
    const World world = posts_between_states();
    const CollisionChecker checker = make_checker(world, coarse_states());
    for (const bool is_continuous : {false, true}) {
      INFO("continuous ", is_continuous);
      SolveSettings settings = settings_for("PRM");
      settings.resolution = coarse_states().resolution;
      settings.plan.timeout_s = 60;
      settings.plan.continuous = is_continuous;
      bool is_free = true;
      for (const Configuration& q : dense(world.robot, solved_path(world, settings), 1e-3)) {
        is_free = is_free && checker.is_valid(q);
      }
      CHECK(is_free == is_continuous);
    }
  }

  TEST_CASE("that OMPL's planner found a path which was not verified is said") {
    // The wall lies between two of the 16 states of the straight motion.
    World world{"", gantry(), {}, {{-1.9, 0, 0}, {{1.9, 0, 0}}}};
    world.scene.obstacles = {make_box("wall", {0.5937, -9, -9}, {0.5938, 9, 9})};
    SolveSettings settings = settings_for("PRM");
    settings.resolution = coarse_states().resolution;
    settings.plan.continuous = true;
    settings.plan.timeout_s = 0.5;
    const SolveResult result = require(solve(problem_of(world), nullptr, settings));
    CHECK(result.plan.status == PlanStatus::timeout);
    CHECK(result.plan.message.ends_with("verification refused 1 path"));
  }

  TEST_CASE("OMPL's planners turn by half a turn on the side that is free") {
    for (const double side : {-1.0, 1.0}) {
      const World world{"half a turn",
                        thick_arm({1, 1}),
                        make_circle_scene("", {{0, 1.5 * side, 0.2}}),
                        {{0, 0.2}, {{kPi, 0.2}}}};
      for (const char* planner : {"PRM", "RRTConnect"}) {
        SolveSettings settings = settings_for(planner);
        settings.plan.timeout_s = 60;
        CHECK(is_path_free(world.robot, world.scene, solved_path(world, settings), 0.001));
      }
    }
  }
}

}  // namespace mneme::test
