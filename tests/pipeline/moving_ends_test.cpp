// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/pipeline.h"

#include "planning/small_worlds.h"

#include <atomic>
#include <memory>

namespace mneme::test {
namespace {

Problem arm_beside(const std::vector<std::array<double, 3>>& circles,
                   std::vector<double> start_velocity) {
  Problem problem{.robot = thick_arm({1, 1, 0.5}),
                  .scene = make_circle_scene("world", circles),
                  .start = {0, 0.1, 0.1},
                  .goals = {{1.5, 0.2, 0.1}}};
  problem.start_velocity = std::move(start_velocity);
  return problem;
}

/// A circle between start and goal.
const std::vector<std::array<double, 3>> kBetween = {{1.4, 1.4, 0.3}};

SolveSettings settings_within(const Robot& robot) {
  TrajectorySettings timing;
  timing.acceleration_limit = 2;
  timing.jerk_limit = 20;
  SolveSettings settings;
  settings.sampler = "uniform";
  settings.plan.limits =
      std::make_shared<const RateLimits>(find_rate_limits(robot, timing).value());
  return settings;
}

Path require_path(const Problem& problem, const SolveSettings& settings) {
  const auto result = solve(problem, nullptr, settings);
  REQUIRE_MESSAGE(result.has_value(), (result ? "" : result.error().message));
  REQUIRE_MESSAGE(result->plan.is_solved(), result->plan.message);
  CHECK(result->plan.path.front() == problem.start);
  CHECK(is_path_free(problem.robot, problem.scene, result->plan.path, 0.002));
  return result->plan.path;
}

/// The timed motion, at states that are free of contact.
Trajectory require_motion(const Problem& problem, const SolveSettings& settings, const Path& path) {
  auto motion = make_trajectory(problem, settings, path, *settings.plan.limits);
  REQUIRE_MESSAGE(motion.has_value(), (motion ? "" : motion.error().message));
  const auto checker = CollisionChecker::make(problem.robot, problem.scene);
  for (int i = 0; i <= 300; ++i) {
    CHECK(checker->contacts(motion->at(motion->duration_s() * i / 300).position).empty());
  }
  return *std::move(motion);
}

TEST_SUITE("flow") {
  TEST_CASE("a robot that moves at the start is planned from where it can stop, and timed") {
    for (const double speed : {-0.4, 0.4}) {
      const Problem problem = arm_beside(kBetween, {speed, 0.2, 0});
      const SolveSettings settings = settings_within(problem.robot);
      const Path path = require_path(problem, settings);
      CHECK(path[1] == stopping_point(problem.robot, problem.start, problem.start_velocity,
                                      *settings.plan.limits)
                           .value());
      const Trajectory motion = require_motion(problem, settings, path);
      CHECK(motion.at(0).velocity[0] == doctest::Approx(speed));
      CHECK(motion.at(0).velocity[1] == doctest::Approx(0.2));
    }
  }

  TEST_CASE("a robot that moves at the goal is planned to where its run-up begins, and timed") {
    for (const std::vector<double>& start : {std::vector<double>{}, {-0.4, 0.2, 0}}) {
      Problem problem = arm_beside(kBetween, start);
      problem.end_velocity = {0.3, -0.2, 0.1};
      const SolveSettings settings = settings_within(problem.robot);
      const Path path = require_path(problem, settings);
      const Configuration& goal = problem.goals.front();
      CHECK(path.back() == goal);
      CHECK(path[path.size() - 2] ==
            run_up_point(problem.robot, goal, problem.end_velocity, *settings.plan.limits).value());
      const auto points = require_motion(problem, settings, path).sample(0.01).value();
      CHECK(points.back().velocity[0] == doctest::Approx(0.3));
      CHECK(points.back().velocity[1] == doctest::Approx(-0.2));
    }
  }

  TEST_CASE("goals without a free run-up are ignored with a note each") {
    Problem problem = arm_beside({{2.3, 0.75, 0.3}}, {});
    problem.start = {-1.5, 0.1, 0.1};
    problem.end_velocity = {-0.6, 0, 0};
    const Configuration blocked = {0, 0.1, 0.1}, far = {1.5, 100, 0.1}, free = {-0.5, 0.2, 0.1};
    problem.goals = {blocked, free, far};
    const auto result = solve(problem, nullptr, settings_within(problem.robot));
    REQUIRE_MESSAGE(result.has_value(), (result ? "" : result.error().message));
    REQUIRE_MESSAGE(result->plan.is_solved(), result->plan.message);
    CHECK(result->goals == std::vector<Configuration>{free});
    REQUIRE(result->notes.size() == 2);
    CHECK(result->notes[0].starts_with("goal 1 is ignored: end velocity: the straight run-up"));
    CHECK(result->notes[1].starts_with("goal 3 is ignored: goal: joint 'joint_2' (value 2 of 3)"));
  }

  TEST_CASE("an end velocity is refused if no run-up is free, or with a pose as the goal") {
    Problem blocked = arm_beside({{2.3, 0.75, 0.3}}, {});
    blocked.start = {-1.5, 0.1, 0.1};
    blocked.goals = {{0, 0.1, 0.1}};
    blocked.end_velocity = {-0.6, 0, 0};
    const SolveSettings settings = settings_within(blocked.robot);
    const auto result = solve(blocked, nullptr, settings);
    CHECK(result->plan.status == PlanStatus::invalid_goal);
    CHECK(result->plan.message.starts_with("end velocity: the straight run-up takes"));
    CHECK(result->plan.message.find("touches '") != std::string::npos);
    blocked.end_velocity = {100, 0, 0};
    CHECK(solve(blocked, nullptr, settings)->plan.message.find("faster than its limit") !=
          std::string::npos);
    PoseGoal pose;
    pose.link = blocked.robot.links().back().name;
    blocked.pose_goals = {pose};
    const auto posed = solve(blocked, nullptr, settings);
    REQUIRE_FALSE(posed.has_value());
    CHECK(posed.error().message.starts_with("end velocity: expected configurations as goals"));
  }

  TEST_CASE("a stop in contact is refused with what it touches, and one beyond limits") {
    const Problem into = arm_beside({{2.3, 0.75, 0.3}}, {0.6, 0, 0});
    const SolveSettings settings = settings_within(into.robot);
    const auto blocked = solve(into, nullptr, settings);
    REQUIRE_MESSAGE(blocked.has_value(), (blocked ? "" : blocked.error().message));
    CHECK(blocked->plan.status == PlanStatus::invalid_start);
    CHECK(blocked->plan.message.starts_with("start velocity: the robot cannot stop in time"));
    CHECK(blocked->plan.message.find("touches '") != std::string::npos);
    CHECK(blocked->plan.path.empty());
    CHECK(blocked->total_time_s > 0);
    CHECK(blocked->preparation_time_s == blocked->total_time_s);

    const auto fast = solve(arm_beside({}, {100, 0, 0}), nullptr, settings);
    CHECK(fast->plan.status == PlanStatus::invalid_start);
    CHECK(fast->isa == default_isa());
    CHECK(fast->plan.message.find("faster than its limit") != std::string::npos);
    const auto wrong = solve(arm_beside({}, {0.1}), nullptr, settings);
    CHECK(wrong->plan.message.find("got 1 values, expected 3") != std::string::npos);
  }

  TEST_CASE("a query that is cancelled does not prepare its moving ends") {
    const Problem into = arm_beside({{2.3, 0.75, 0.3}}, {0.6, 0, 0});
    SolveSettings settings = settings_within(into.robot);
    const std::atomic<bool> is_cancelled = true;
    settings.plan.cancel = &is_cancelled;
    const auto result = require(solve(into, nullptr, settings));
    CHECK(result.plan.status == PlanStatus::cancelled);
    CHECK(result.isa == default_isa());
  }

  TEST_CASE("the times of a moving problem add up to its total") {
    Problem problem = arm_beside(kBetween, {-0.4, 0.2, 0});
    problem.end_velocity = {0.3, -0.2, 0.1};
    const auto result = require(solve(problem, nullptr, settings_within(problem.robot)));
    REQUIRE(result.plan.is_solved());
    CHECK(result.preparation_time_s + result.planning_time_s + result.plan.simplification_time_s +
              result.plan.verification_time_s + result.improvement_time_s +
              result.remembered.time_s ==
          doctest::Approx(result.total_time_s));
  }

  TEST_CASE("velocities as small as noise of encoders are planned and timed") {
    for (const double speed : {1e-12, 1e-6, 1e-3, 1e-2}) {
      CAPTURE(speed);
      const Problem problem = arm_beside(kBetween, {speed, -speed, 0});
      const SolveSettings settings = settings_within(problem.robot);
      const auto result = solve(problem, nullptr, settings);
      REQUIRE(result->plan.is_solved());
      const auto motion =
          make_trajectory(problem, settings, result->plan.path, *settings.plan.limits);
      CHECK_MESSAGE(motion.has_value(), (motion ? "" : motion.error().message));
    }
  }

  TEST_CASE("velocities of zeros change nothing") {
    const Problem still = arm_beside(kBetween, {});
    const SolveSettings settings = settings_within(still.robot);
    Problem zeros = arm_beside(kBetween, {0, 0, 0});
    zeros.end_velocity = {0, 0, 0};
    CHECK(solve(zeros, nullptr, settings)->plan.path == solve(still, nullptr, settings)->plan.path);
  }
}

}  // namespace
}  // namespace mneme::test
