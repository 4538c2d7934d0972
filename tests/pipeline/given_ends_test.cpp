// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Starts and goals that are barely outside of what motions keep.
#include "mneme/pipeline.h"
#include "mneme/spheres.h"

#include "goal/posed_robots.h"
#include "pipeline/notes.h"
#include "planning/small_worlds.h"

#include <algorithm>
#include <chrono>
#include <string>
#include <thread>

namespace mneme::test {
namespace {

SolveResult require_checked(const Problem& problem, const SolveSettings& settings = {}) {
  SolveResult result = require_solved(problem, nullptr, settings);
  const Scene& scene = checked_scene(problem, result);
  CHECK(result.plan.path.front() == problem.start);
  CHECK(is_path_free(problem.robot, scene, result.plan.path, 0.002, end_tolerances(settings)));
  return result;
}

PlanStatus status_of(const Problem& problem, const SolveSettings& settings) {
  return solve(problem, nullptr, settings).value().plan.status;
}

Problem make_problem(Robot robot, Scene scene, Configuration start, Configuration goal) {
  return {.robot = std::move(robot),
          .scene = std::move(scene),
          .start = std::move(start),
          .goals = {std::move(goal)}};
}

Problem planar_world(Configuration start, Configuration goal,
                     const std::vector<std::array<double, 3>>& circles) {
  return make_problem(thick_arm({1, 1, 0.5}), make_circle_scene("world", circles), std::move(start),
                      std::move(goal));
}

Robot panda_with_box() {
  const Box box{{Eigen::Matrix3d::Identity(), {0, 0, 0.16}}, {0.02, 0.02, 0.06}};
  AttachedObject object{"object", kHand, {box}, {}, {"panda_leftfinger", "panda_rightfinger"}};
  return attach(shipped_robot("panda"), {object}).value();
}

/// A box in the hand of a Panda that stands on a table at start and goal.
struct Placing {
  Problem problem = make_problem(
      panda_with_box(), {"cell", {make_box("table", {0, -0.8, -0.1}, {1, 0.8, 0})}}, {}, {});
  int hand = *problem.robot.find_link(kHand);

  explicit Placing(double depth = 0) {
    problem.start = at(0.45, -0.45, depth);
    problem.goals = {at(0.45, 0.45, depth)};
  }
  /// The hand points down; the lower end of the box is `depth` below the table's top.
  [[nodiscard]] Configuration at(double x, double y, double depth) const {
    PoseGoal goal;
    goal.link = kHand;
    goal.pose.rotation = Vec3(1, -1, -1).asDiagonal();
    goal.pose.translation = {x, y, 0.22 - depth};
    const auto reached =
        require(InverseKinematics::make(problem.robot, kHand))
            .solve(goal, kReady, {.position_tolerance = 1e-5, .rotation_tolerance = 1e-4});
    REQUIRE(!reached.solutions.empty());
    return reached.solutions.front();
  }
  /// The lowest point of the box on straight lines between the waypoints, metres.
  [[nodiscard]] double lowest(const Path& path) const {
    double least = 1;
    for (std::size_t i = 1; i < path.size(); ++i) {
      const Configuration delta = problem.robot.difference(path[i - 1], path[i]);
      for (int k = 0; k <= 200; ++k) {
        Configuration q = path[i - 1];
        for (std::size_t j = 0; j < q.size(); ++j) q[j] += delta[j] * k / 200;
        const Transform pose = problem.robot.link_poses(q)[static_cast<std::size_t>(hand)];
        for (const double x : {-0.02, 0.02}) {
          for (const double y : {-0.02, 0.02}) {
            least = std::min(least, (pose * Vec3(x, y, 0.22))[2]);
          }
        }
      }
    }
    return least;
  }
};

}  // namespace

TEST_SUITE("flow") {
  TEST_CASE("a start a little beyond a limit is kept and led inside by the first motion") {
    Problem problem = planar_world({0, 0.5, 0}, {1, 0.3, 0.2}, {});
    const Robot& arm = problem.robot;
    const double most = arm.group_joint(2).upper;
    problem.start[2] = most + 0.03;
    const SolveResult result = require_checked(problem);
    CHECK_FALSE(arm.describe_violation(result.plan.path[1], ""));
    CHECK(has_note(result, "beyond its limit"));
    SolveSettings strict;
    strict.start_tolerance = 0;
    CHECK(status_of(problem, strict) == PlanStatus::invalid_start);
    problem.start[2] = most + 0.06;
    CHECK(status_of(problem, {}) == PlanStatus::invalid_start);
    std::swap(problem.start, problem.goals[0]);
    CHECK(status_of(problem, {}) == PlanStatus::invalid_goal);
  }

  TEST_CASE("the trajectory of such a path begins at the given start") {
    Problem problem = planar_world({0, 0.5, 0}, {1, 0.3, 0.2}, {});
    problem.start[2] = problem.robot.group_joint(2).lower - 0.01;
    const SolveResult result = require_checked(problem);
    const RateLimits limits{Configuration(3, 1.0), Configuration(3, 1.0)};
    const auto motion = require(make_trajectory(problem, {}, result.plan.path, limits));
    CHECK(motion.at(0).position == problem.start);
    double lowest = 0;
    for (double t = 0; t < motion.duration_s(); t += 0.001) {
      lowest = std::min(lowest, motion.at(t).position[2]);
    }
    CHECK(lowest == problem.start[2]);
  }

  TEST_CASE("a start barely in contact is left by the first motion") {
    // The last link overlaps the post by half a millimetre.
    const double radius = thick_arm({1, 1, 0.5}).links().back().capsules.front().radius;
    Problem problem = planar_world({0, 0, 0}, {-1, 0.3, 0.2}, {{2.25, 0.3 + radius - 5e-4, 0.3}});
    const SolveResult result = require_checked(problem);
    CHECK(has_note(result, "touches obstacle 'circle_1'; the first motion leads away"));
    CHECK_FALSE(is_path_free(problem.robot, problem.scene, result.plan.path, 0.002));
    problem.scene = make_circle_scene("deeper", {{2.25, 0.3 + radius - 2e-3, 0.3}});
    CHECK(status_of(problem, {}) == PlanStatus::invalid_start);
  }

  TEST_CASE("a start that the tolerance allows is refused for its contact") {
    Problem problem = planar_world({0, 0, 0}, {-1, 0.3, 0.2}, {});
    problem.start[2] = problem.robot.group_joint(2).lower - 0.01;
    const Transform last = problem.robot.link_poses(problem.start).back();
    problem.scene = make_circle_scene("world", {{last.translation.x(), last.translation.y(), 0.3}});
    const auto result = solve(problem, nullptr, {});
    CHECK(result->plan.status == PlanStatus::invalid_start);
    const std::string& message = result->plan.message;
    CHECK_MESSAGE(message.starts_with("start is in contact: "), message);
    CHECK_MESSAGE(message.find("'circle_1'") != std::string::npos, message);
    CHECK_MESSAGE(message.find("0.01 rad beyond its limit, which start-tolerance allows") !=
                      std::string::npos,
                  message);
  }

  TEST_CASE("a start beyond a limit is refused for the contact that it has only there") {
    Problem problem = planar_world({0, 0, 0}, {-1, 0.3, 0.2}, {});
    problem.start[2] = problem.robot.group_joint(2).lower - 0.04;
    const Transform last = problem.robot.link_poses(problem.start).back();
    const double radius = problem.robot.links().back().capsules.front().radius;
    // 1 cm deep; the joint at its limit is 1 cm away.
    const Vec3 center = last * Vec3(0.5, -0.3 - radius + 0.01, 0);
    problem.scene = make_circle_scene("world", {{center.x(), center.y(), 0.3}});
    const auto result = solve(problem, nullptr, {});
    CHECK(result->plan.status == PlanStatus::invalid_start);
    const std::string& message = result->plan.message;
    CHECK_MESSAGE(message.find("touches obstacle 'circle_1'") != std::string::npos, message);
    CHECK_MESSAGE(message.find("0.04 rad beyond its limit") != std::string::npos, message);
  }

  TEST_CASE("many held bodies in contact are examined with looks at the clock") {
    Problem problem = planar_world({0, 0, 0}, {-1, 0.3, 0.2}, {});
    std::vector<AttachedObject> bodies;
    const auto links = problem.robot.links();
    for (std::size_t i = 0; i < 60; ++i) {
      bodies.push_back({"body" + std::to_string(i), links[i % 3].name, {Sphere{{0, 0, 0}, 5}}});
    }
    problem.robot = require(attach(problem.robot, bodies));
    int polls = 0;
    {
      const InterruptScope counting([&] { return ++polls < 0; });
      CHECK(status_of(problem, {}) == PlanStatus::invalid_start);
    }
    CHECK(polls > 100);
    int seen = 0;
    {
      const InterruptScope ending([&] { return ++seen >= polls / 2; });
      CHECK_THROWS_AS(static_cast<void>(solve(problem, nullptr, {})), Interrupted);
    }
    SolveSettings settings;
    settings.plan.timeout_s = 0;
    const InterruptScope slow([] {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      return false;
    });
    const PlanResult late = require(solve(problem, nullptr, settings)).plan;
    CHECK(late.status == PlanStatus::timeout);
    CHECK_MESSAGE(contains(late.message, "before start and goals were examined"), late.message);
  }

  TEST_CASE("a link that may touch an obstacle at the ends does so there alone") {
    const double radius = thick_arm({1, 1, 0.5}).links().back().capsules.front().radius;
    Problem problem = planar_world({0, 0, 0}, {-1, 0.3, 0.2}, {{2.25, 0.3 + radius - 8e-3, 0.3}});
    CHECK(status_of(problem, {}) == PlanStatus::invalid_start);
    const std::string link = problem.robot.links().back().name;
    problem.scene.end_contacts = {{link, problem.scene.obstacles[0].name, 0.03}};
    SolveSettings no_others;
    no_others.allow_at_ends = no_others.start_tolerance = 0;
    for (const SolveSettings& settings : {SolveSettings(), no_others}) {
      CHECK(status_of(problem, settings) == PlanStatus::solved);
    }
    const SolveResult left = require_checked(problem);
    CHECK(has_note(left, "touches obstacle 'circle_1'; the first motion leads away"));
    CHECK(is_path_free(problem.robot, problem.scene,
                       {left.plan.path.begin() + 1, left.plan.path.end()}, 0.002));
    std::swap(problem.start, problem.goals[0]);
    CHECK(has_note(require_checked(problem), "the last motion leads there"));
    problem.scene.end_contacts[0].first = "hand";
    CHECK(contains(require_error(solve(problem, nullptr, {})).message,
                   "at the ends of a path of 'hand'"));
  }

  TEST_CASE("a start that leans a little beyond its cone is led inside") {
    Problem problem = planar_world({0.34, 0, 0}, {-0.2, 0.3, -0.1}, {});
    const std::string tip = problem.robot.links().back().name;
    problem.constraints = {{tip, Vec3::UnitX(), Vec3::UnitX(), 0.3}};
    const SolveResult result = require_checked(problem);
    CHECK(has_note(result, "beyond its cone"));
    CHECK(keeps_cone(problem.robot, problem.constraints[0], result.plan.path, 0.001,
                     end_tolerances({})));
    problem.start[0] = 0.36;
    CHECK(status_of(problem, {}) == PlanStatus::invalid_start);
  }

  TEST_CASE("a held object leaves the table, and is put on it again") {
    for (const double depth : {0.0, 0.002}) {
      const Placing placing(depth);
      const SolveResult result = require_checked(placing.problem);
      CHECK(result.plan.path.back() == placing.problem.goals[0]);
      CHECK(placing.lowest(result.plan.path) > -depth - 1e-4);
      CHECK(has_note(result, "start: 'object' touches obstacle 'table'"));
      CHECK(has_note(result, "goal: 'object' touches obstacle 'table'"));
      SolveSettings strict;
      strict.allow_at_ends = 0;
      strict.start_tolerance = 0;
      CHECK(status_of(placing.problem, strict) == PlanStatus::invalid_start);
    }
  }

  TEST_CASE("a held object is put on the table where a pose says so") {
    Placing placing;
    PoseGoal pose;
    pose.link = kHand;
    const Configuration& goal = placing.problem.goals[0];
    pose.pose = placing.problem.robot.link_poses(goal)[static_cast<std::size_t>(placing.hand)];
    placing.problem.pose_goals = {pose};
    placing.problem.goals.clear();
    const SolveResult result = require_checked(placing.problem);
    const PoseError error = pose_error(placing.problem.robot, pose, result.plan.path.back());
    CHECK(error.position < 1e-4);
    CHECK(placing.lowest(result.plan.path) > -3e-4);
  }

  TEST_CASE(
      "a held object that may touch the table does so at the ends only, if that is possible") {
    Placing placing;
    placing.problem.scene.obstacles[0].may_touch = {"object"};
    const SolveResult result = require_checked(placing.problem);
    CHECK(placing.lowest(result.plan.path) > -1e-4);
    // Too deep in the table to leave it within 5 mm: then it may touch everywhere.
    Placing deep(0.02);
    CHECK(status_of(deep.problem, {}) == PlanStatus::invalid_start);
    deep.problem.scene.obstacles[0].may_touch = {"object"};
    CHECK(has_note(require_checked(deep.problem), "no path was found without"));
  }
}

}  // namespace mneme::test
