// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Goals that are poses, from problem to path.
#include "goal/posed_robots.h"
#include "pipeline/notes.h"
#include "planning/small_worlds.h"

#include <algorithm>
#include <atomic>
#include <memory>
#include <string>

namespace mneme::test {
namespace {

/// The Panda is to go from one side of a post to the other.
Problem posed_problem(const Configuration& at) {
  Problem problem{.name = "posed", .robot = shipped_robot("panda"), .start = kReady};
  const Transform at_post{Eigen::Matrix3d::Identity(), Vec3(0.5, 0.3, 0.4)};
  problem.scene.obstacles.push_back({"post", {Cylinder{at_post, 0.05, 0.8}}});
  problem.pose_goals = {pose_at(problem.robot, kHand, at)};
  return problem;
}

/// Many goals of a planar arm beside a circle, at angles of its first joint. Those around 1.5 are
/// in contact.
Problem problem_of_many(int count, double first, double last) {
  Problem problem{.robot = thick_arm({1, 1, 0.5}),
                  .scene = make_circle_scene("world", {{0, 2, 0.5}}),
                  .start = {-1, 0.1, 0.1}};
  for (int i = 0; i < count; ++i) {
    problem.goals.push_back({first + (last - first) * i / std::max(1, count - 1), 0.1, 0.1});
  }
  return problem;
}

SolveResult solve_soundly(const Problem& problem, const SolveSettings& settings) {
  return require(solve(problem, nullptr, settings));
}

TEST_SUITE("flow") {
  TEST_CASE("every planner of mneme goes to a pose") {
    const Problem problem = posed_problem({1, 0.3, 0.1, -1.5, 0, 1.9, 0.5});
    for (const std::string planner : {"rrt_connect", "rrt", "prm"}) {
      CAPTURE(planner);
      SolveSettings settings;
      settings.planner = planner;
      settings.plan.timeout_s = 60;
      const SolveResult result = solve_soundly(problem, settings);
      REQUIRE_MESSAGE(result.plan.is_solved(), result.plan.message);
      CHECK(!result.goals.empty());
      CHECK(static_cast<int>(result.goals.size()) <= settings.ik.solutions);
      CHECK(result.goal_time_s > 0);
      CHECK(result.goal_time_s < result.planning_time_s);
      const PoseError error =
          pose_error(problem.robot, problem.pose_goals[0], result.plan.path.back());
      CHECK(error.position <= settings.ik.position_tolerance);
      CHECK(error.rotation <= settings.ik.rotation_tolerance);
      CHECK(is_path_free(problem.robot, problem.scene, result.plan.path, 0.01));
    }
  }

  TEST_CASE("the same seed gives the same path to a pose, another one may not") {
    const Problem problem = posed_problem({1, 0.3, 0.1, -1.5, 0, 1.9, 0.5});
    SolveSettings settings;
    settings.plan.max_iterations = 100000;
    settings.plan.timeout_s = 60;
    const SolveResult first = solve_soundly(problem, settings);
    CHECK(first.plan.path == solve_soundly(problem, settings).plan.path);
    settings.plan.seed = 2;
    CHECK(first.goals != solve_soundly(problem, settings).goals);
  }

  TEST_CASE("the goal that was reached is among those that are told") {
    Problem problem = posed_problem({1, 0.3, 0.1, -1.5, 0, 1.9, 0.5});
    SolveSettings settings;
    settings.planner = "rrt";
    settings.plan.timeout_s = 60;
    settings.ik.solutions = 1;
    std::size_t later = 0;
    for (settings.plan.seed = 1; settings.plan.seed <= 8; ++settings.plan.seed) {
      const SolveResult result = solve_soundly(problem, settings);
      REQUIRE_MESSAGE(result.plan.is_solved(), result.plan.message);
      const auto is_end = [&](const Configuration& goal) {
        return problem.robot.distance(goal, result.plan.path.back()) < 1e-6;
      };
      CHECK(std::ranges::any_of(result.goals, is_end));
      later += result.goals.size() - 1;
    }
    CHECK(later > 0);
  }

  TEST_CASE("poses stand beside configurations") {
    Problem problem = posed_problem({1, 0.3, 0.1, -1.5, 0, 1.9, 0.5});
    const Configuration near = {0.1, -0.785, 0, -2.356, 0, 1.571, 0.785};
    problem.goals = {near};
    const SolveResult result = solve_soundly(problem, {});
    REQUIRE_MESSAGE(result.plan.is_solved(), result.plan.message);
    CHECK(result.goals.size() > 1);
    CHECK(result.plan.path.back() == near);
    CHECK(result.notes.empty());
    problem.pose_goals.push_back(problem.pose_goals[0]);
    problem.pose_goals[1].pose.translation.x() += 20;
    const SolveResult noted = solve_soundly(problem, {});
    REQUIRE(noted.notes.size() == 1);
    CHECK(noted.notes[0].starts_with("goal pose 1: no configuration from "));
  }
}

TEST_SUITE("flow") {
  TEST_CASE("of many goals the valid ones are planned to, and the others are counted") {
    SolveSettings settings;
    settings.plan.timeout_s = 600;
    // The first hundred are in contact.
    Problem problem = problem_of_many(100, 1.4, 1.6);
    const Problem free = problem_of_many(300, -0.5, 0.5);
    problem.goals.insert(problem.goals.end(), free.goals.begin(), free.goals.end());
    problem.goals.push_back(problem.goals.front());
    const SolveResult result = solve_soundly(problem, settings);
    REQUIRE_MESSAGE(result.plan.is_solved(), result.plan.message);
    CHECK(result.goals.size() == 300);
    CHECK(std::ranges::count(problem.goals, result.plan.path.back()) == 1);
    CHECK(has_note(result, "goals 1 to 64 are ignored: goal 1 is in contact"));
    CHECK(has_note(result, "goal 100 is in contact"));
    CHECK(has_note(result, "1 of the goals from goal 129 on are ignored"));
    CHECK(result.notes.size() < 50);
  }

  TEST_CASE("many goals in contact are refused with the first contact") {
    SolveSettings settings;
    settings.plan.timeout_s = 600;
    const SolveResult result = solve_soundly(problem_of_many(500, 1.4, 1.6), settings);
    CHECK(result.plan.status == PlanStatus::invalid_goal);
    CHECK_MESSAGE(result.plan.message.starts_with("goal 1 is in contact: "), result.plan.message);
    CHECK(result.plan.message.find("no other of the 500 goals is valid") != std::string::npos);
  }

  TEST_CASE("many goals are looked at within the time limit, and no longer than wanted") {
    SolveSettings settings;
    SUBCASE("out of time, with valid goals") {
      settings.plan.timeout_s = 0;
      const SolveResult result = solve_soundly(problem_of_many(20000, -0.5, 0.5), settings);
      CHECK(result.plan.status == PlanStatus::timeout);
      CHECK(result.goals.size() == 64);
      CHECK(has_note(result, "the goals from goal 65 on are ignored"));
    }
    SUBCASE("out of time, with goals in contact") {
      settings.plan.timeout_s = 0;
      const SolveResult result = solve_soundly(problem_of_many(20000, 1.4, 1.6), settings);
      CHECK(result.plan.status == PlanStatus::timeout);
      CHECK(result.plan.message.starts_with("no valid goal among the first 64 of 20000"));
    }
    SUBCASE("cancelled") {
      const std::atomic<bool> cancel = true;
      settings.plan.cancel = &cancel;
      const SolveResult result = solve_soundly(problem_of_many(20000, -0.5, 0.5), settings);
      CHECK(result.plan.status == PlanStatus::cancelled);
    }
    SUBCASE("out of time, with run-ups") {
      settings.plan.timeout_s = 0;
      Problem problem = problem_of_many(20000, -0.5, 0.5);
      problem.end_velocity = {0.01, 0, 0};
      TrajectorySettings timing;
      timing.acceleration_limit = 2;
      settings.plan.limits =
          std::make_shared<const RateLimits>(find_rate_limits(problem.robot, timing).value());
      const SolveResult result = solve_soundly(problem, settings);
      CHECK(result.plan.status == PlanStatus::timeout);
      CHECK(has_note(result, "the goals from goal 2 on are ignored"));
    }
  }
}

TEST_SUITE("unit") {
  TEST_CASE("a pose that nothing reaches is an invalid goal that says why") {
    Problem problem = posed_problem(kReady);
    problem.pose_goals[0].pose.translation = Vec3(2, 0, 0.5);
    const SolveResult result = solve_soundly(problem, {});
    CHECK(result.plan.status == PlanStatus::invalid_goal);
    CHECK_MESSAGE(result.plan.message.starts_with(
                      "goal pose: the pose is out of reach of link 'panda_hand' by 1"),
                  result.plan.message);
    CHECK(result.goals.empty());
  }

  TEST_CASE("poses are looked at within the time limit, and no longer than wanted") {
    Problem problem = posed_problem(kReady);
    problem.pose_goals[0].pose.translation = Vec3(2, 0, 0.5);
    SolveSettings settings;
    settings.ik.seeds = 100000000;
    SUBCASE("out of time") {
      settings.plan.timeout_s = 0;
      const SolveResult result = solve_soundly(problem, settings);
      CHECK(result.plan.status == PlanStatus::timeout);
      CHECK(contains(result.plan.message, "within the time limit"));
    }
    SUBCASE("a little time") {
      settings.plan.timeout_s = 0.01;
      CHECK(solve_soundly(problem, settings).plan.status == PlanStatus::timeout);
    }
    SUBCASE("cancelled") {
      const std::atomic<bool> cancel = true;
      settings.plan.cancel = &cancel;
      CHECK(solve_soundly(problem, settings).plan.status == PlanStatus::cancelled);
    }
  }

  TEST_CASE("a wrong start is told before the pose is looked at") {
    Problem problem = posed_problem(kReady);
    problem.start.pop_back();
    const SolveResult result = solve_soundly(problem, {});
    CHECK(result.plan.status == PlanStatus::invalid_start);
    CHECK(contains(result.plan.message, "there are 6 values"));
  }

  TEST_CASE("a pose of an unknown link is an error") {
    Problem problem = posed_problem(kReady);
    problem.pose_goals[0].link = "nose";
    CHECK(require_error(solve(problem, nullptr, {})).message ==
          "expected a link of robot panda, got \"nose\"");
  }
}

}  // namespace
}  // namespace mneme::test
