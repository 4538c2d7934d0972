// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Plans between configurations at which only covers touch.
#include "mneme/covering.h"
#include "mneme/pipeline.h"

#include "support/support.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

namespace mneme::test {
namespace {

const Box kForearm{{Eigen::Matrix3d::Identity(), {0.4, 0, 0}}, {0.35, 0.05, 0.05}};

/// Turns about z and lifts its forearm, a covered box along x that begins 0.5 m from the axis.
Robot covered_arm() {
  const auto parts = parse_robot_parts(
      R"(<robot name="arm"><link name="base"/><link name="upper"/>
      <link name="forearm"><collision><origin xyz="0.4 0 0"/><geometry><box size="0.7 0.1 0.1"/>
      </geometry></collision></link>
      <joint name="turn" type="revolute"><parent link="base"/><child link="upper"/>
      <axis xyz="0 0 1"/><limit lower="-3" upper="3" velocity="1"/></joint>
      <joint name="lift" type="revolute"><parent link="upper"/><child link="forearm"/>
      <origin xyz="0.5 0 0"/><axis xyz="0 -1 0"/><limit lower="-1" upper="1" velocity="1"/></joint>
      </robot>)",
      "arm.urdf");
  REQUIRE(parts.has_value());
  const auto covering = cover_robot(*parts);
  REQUIRE(covering.has_value());
  const auto robot = make_robot(covering->parts);
  REQUIRE(robot.has_value());
  return *robot;
}

/// Two boxes side by side that turn about parallel axes beyond a mast; the hand's plate is `gap`
/// metres beside the mast's at zero.
Problem beside_its_mast(double gap) {
  const std::string text = fmt::format(
      R"(<robot name="arm"><link name="base"><collision><origin xyz="0 0 0.5"/><geometry>
      <box size="0.2 0.2 1"/></geometry></collision></link><link name="upper"/>
      <link name="hand"><collision><origin xyz="0 {} 0"/><geometry><box size="0.2 0.1 0.6"/>
      </geometry></collision></link>
      <joint name="lift" type="prismatic"><parent link="base"/><child link="upper"/>
      <origin xyz="0 0 0.5"/><axis xyz="0 0 1"/><limit lower="-0.2" upper="0.2" velocity="1"/>
      </joint><joint name="out" type="prismatic"><parent link="upper"/><child link="hand"/>
      <axis xyz="0 1 0"/><limit lower="-0.1" upper="0.5" velocity="1"/></joint></robot>)",
      0.1 + 0.05 + gap);
  const auto parts = parse_robot_parts(text, "arm.urdf");
  REQUIRE(parts.has_value());
  CoverSettings coarse;
  coarse.excess = 0.03;
  const auto covering = cover_robot(*parts, coarse);
  REQUIRE(covering.has_value());
  const auto robot = make_robot(covering->parts);
  REQUIRE_MESSAGE(robot.has_value(), (robot ? "" : robot.error().message));
  REQUIRE(robot->self_pairs().size() == 1);
  return {"beside its mast", *robot, "", {}, {-0.2, 0}, {{0.2, 0}}, {}};
}

/// Below a plate, whose lower side is `gap` metres above the forearm, and raised beside it.
Problem below_a_plate(double gap) {
  Problem problem{"below a plate", covered_arm(), "", {}, {0, 0}, {{1.2, 0.7}}, {}};
  const Box plate{{Eigen::Matrix3d::Identity(), {0.9, 0, 0.05 + gap + 0.05}}, {0.2, 0.2, 0.05}};
  problem.scene.obstacles = {{"plate", {plate}}};
  return problem;
}

SolveResult require_solve(const Problem& problem, const SolveSettings& settings = {}) {
  auto result = solve(problem, nullptr, settings);
  REQUIRE_MESSAGE(result.has_value(), (result ? "" : result.error().message));
  return *std::move(result);
}

/// Metres, by the box itself, at states of the path.
double least_gap(const Problem& problem, const Path& path) {
  double least = 1e9;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Configuration way = problem.robot.difference(path[i - 1], path[i]);
    const int steps = 1 + static_cast<int>(problem.robot.distance(path[i - 1], path[i]) / 0.005);
    for (int k = 0; k <= steps; ++k) {
      Configuration q = path[i - 1];
      for (std::size_t j = 0; j < q.size(); ++j) q[j] += way[j] * k / steps;
      const Shape forearm = transformed(problem.robot.link_poses(q).back(), kForearm);
      least = std::min(least, distance(forearm, problem.scene.obstacles[0].shapes[0]));
    }
  }
  return least;
}

TEST_SUITE("flow") {
  TEST_CASE("where only a cover touches, plans are checked by what it covers") {
    Problem problem = below_a_plate(0.003);
    for (const bool is_backward : {false, true}) {
      if (is_backward) std::swap(problem.start, problem.goals[0]);
      for (const char* planner : {"rrt_connect", "rrt", "prm"}) {
        for (std::uint64_t seed = 1; seed <= 3; ++seed) {
          SolveSettings settings;
          settings.planner = planner;
          settings.plan.seed = seed;
          const SolveResult result = require_solve(problem, settings);
          INFO(planner << ", seed " << seed << ": " << result.plan.message);
          REQUIRE(result.plan.is_solved());
          REQUIRE(result.notes.size() == 1);
          CHECK(result.notes[0].starts_with(
              std::string(is_backward ? "goal" : "start") +
              ": link 'forearm' comes close to obstacle 'plate' with its cover only"));
          CHECK(result.notes[0].ends_with("; they are checked by what it covers, 3 mm away"));
          CHECK(least_gap(problem, result.plan.path) > 1e-4);
          CHECK(
              is_path_free(problem.robot, checked_scene(problem, result), result.plan.path, 0.01));
          CHECK_FALSE(is_path_free(problem.robot, problem.scene, result.plan.path, 0.01));
          const auto limits = find_rate_limits(problem.robot);
          REQUIRE(limits.has_value());
          const auto timed = make_trajectory(problem, settings, result.plan.path, *limits);
          REQUIRE(timed.has_value());
          Path states;
          for (double time = 0; time < timed->duration_s(); time += 0.01) {
            states.push_back(timed->at(time).position);
          }
          CHECK(least_gap(problem, states) > 1e-4);
        }
      }
    }
  }

  TEST_CASE(
      "where links touch each other with covers only, plans are checked by what these cover") {
    Problem problem = beside_its_mast(0.004);
    const auto is_apart = [](const Configuration& q) { return q[1] > -0.004; };
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      SolveSettings settings;
      settings.plan.seed = seed;
      const SolveResult result = require_solve(problem, settings);
      INFO("seed " << seed << ": " << result.plan.message);
      REQUIRE(result.plan.is_solved());
      REQUIRE(result.notes.size() == 1);
      CHECK(
          result.notes[0].starts_with("start: links 'base' and 'hand' touch with their covers "
                                      "only, which together stick out by up to "));
      CHECK(result.notes[0].ends_with("; they are checked by what these cover, 4 mm apart"));
      CHECK(checked_scene(problem, result).by_solid.size() == 1);
      CHECK(std::ranges::all_of(result.plan.path, is_apart));
      CHECK(is_path_free(problem.robot, checked_scene(problem, result), result.plan.path, 0.01));
      CHECK_FALSE(is_path_free(problem.robot, problem.scene, result.plan.path, 0.01));
      const auto limits = find_rate_limits(problem.robot);
      REQUIRE(limits.has_value());
      const auto timed = make_trajectory(problem, settings, result.plan.path, *limits);
      REQUIRE(timed.has_value());
      for (double time = 0; time < timed->duration_s(); time += 0.01) {
        CHECK(is_apart(timed->at(time).position));
      }
    }
    problem.goals = {{0.2, -0.01}};
    const SolveResult refused = require_solve(problem);
    CHECK(refused.plan.status == PlanStatus::invalid_goal);
    CHECK(refused.plan.message.find("link 'base' touches link 'hand'") != std::string::npos);
    CHECK(refused.plan.message.find("what is covered touches, too") != std::string::npos);
    for (const double gap : {-0.001, 0.0005}) {
      CHECK(require_solve(beside_its_mast(gap)).plan.status == PlanStatus::invalid_start);
    }
  }

  TEST_CASE("a pose that is reached with touching covers only is judged by what they cover") {
    Problem problem = beside_its_mast(0.004);
    problem.start = {0, 0.4};
    problem.goals = {};
    PoseGoal pose;
    pose.link = "hand";
    pose.pose = problem.robot.link_poses(Configuration{0.1, 0}).back();
    problem.pose_goals = {pose};
    const SolveResult result = require_solve(problem);
    INFO(result.plan.message);
    REQUIRE(result.plan.is_solved());
    REQUIRE(result.notes.size() == 1);
    CHECK(result.notes[0].starts_with("goal: links 'base' and 'hand' touch with their covers"));
    CHECK(is_path_free(problem.robot, checked_scene(problem, result), result.plan.path, 0.01));
    const auto limits = find_rate_limits(problem.robot);
    REQUIRE(limits.has_value());
    CHECK(make_trajectory(problem, {}, result.plan.path, *limits).has_value());
    problem.pose_goals[0].pose.translation.y() -= 0.01;
    const SolveResult refused = require_solve(problem);
    CHECK(refused.plan.status == PlanStatus::invalid_goal);
    CHECK(refused.notes.empty());
  }

  TEST_CASE("what is too close to be told from contact is refused, as ever") {
    for (const double gap : {-0.001, 0.0005}) {
      const SolveResult result = require_solve(below_a_plate(gap));
      CHECK(result.plan.status == PlanStatus::invalid_start);
      CHECK(result.notes.empty());
      CHECK_FALSE(result.scene.has_value());
    }
    SolveSettings settings;
    settings.margin = 0.005;
    CHECK(require_solve(below_a_plate(0.003), settings).plan.status == PlanStatus::invalid_start);
    CHECK(require_solve(below_a_plate(0.007), settings).plan.is_solved());
  }

  TEST_CASE("plans that touch nowhere are as they were") {
    const Problem problem = below_a_plate(0.1);
    const SolveResult result = require_solve(problem);
    CHECK(result.plan.is_solved());
    CHECK(result.notes.empty());
    CHECK(&checked_scene(problem, result) == &problem.scene);
  }
}

}  // namespace
}  // namespace mneme::test
