// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Plans between configurations at which only spheres touch.
#include "mneme/spheres.h"
#include "mneme/pipeline.h"

#include "support/support.h"

#include <algorithm>
#include <array>
#include <string>

namespace mneme::test {
namespace {

const Box kForearm{{Eigen::Matrix3d::Identity(), {0.4, 0, 0}}, {0.35, 0.05, 0.05}};

/// The moving box: of a link, or carried.
enum class Whose { its_own, carried };
constexpr std::array kAll = {Whose::its_own, Whose::carried};

/// The box is the last link's, or of an object "load" that this carries.
Robot approximated_robot(const std::string& urdf, const Box& box, Whose whose, double excess) {
  auto parts = require(parse_robot_parts(urdf, "arm.urdf"));
  if (whose == Whose::its_own) parts.links.back().solids = {box};
  const auto made = require(approximate_robot(parts, {.excess = excess}));
  auto robot = make_robot(made.parts);
  REQUIRE_MESSAGE(robot.has_value(), (robot ? "" : robot.error().message));
  if (whose == Whose::carried) robot = attach(*robot, {{"load", parts.links.back().name, {box}}});
  REQUIRE_MESSAGE(robot.has_value(), (robot ? "" : robot.error().message));
  return *robot;
}

/// Turns about z and lifts its forearm, a box in spheres along x that begins 0.5 m from the axis.
Robot approximated_arm(Whose whose) {
  return approximated_robot(R"(<robot name="arm"><link name="base"/><link name="upper"/>
      <link name="forearm"/>
      <joint name="turn" type="revolute"><parent link="base"/><child link="upper"/>
      <axis xyz="0 0 1"/><limit lower="-3" upper="3" velocity="1"/></joint>
      <joint name="lift" type="revolute"><parent link="upper"/><child link="forearm"/>
      <origin xyz="0.5 0 0"/><axis xyz="0 -1 0"/><limit lower="-1" upper="1" velocity="1"/></joint>
      </robot>)",
                            kForearm, whose, 0.015);
}

/// A plate that slides along a mast and away from it; it is `gap` metres beside the mast at zero.
Problem beside_its_mast(double gap, Whose whose = Whose::its_own) {
  const Robot robot = approximated_robot(
      R"(<robot name="arm"><link name="base"><collision><origin xyz="0 0 0.5"/><geometry>
      <box size="0.2 0.2 1"/></geometry></collision></link><link name="upper"/><link name="hand"/>
      <joint name="lift" type="prismatic"><parent link="base"/><child link="upper"/>
      <origin xyz="0 0 0.5"/><axis xyz="0 0 1"/><limit lower="-0.2" upper="0.2" velocity="1"/>
      </joint><joint name="out" type="prismatic"><parent link="upper"/><child link="hand"/>
      <axis xyz="0 1 0"/><limit lower="-0.1" upper="0.5" velocity="1"/></joint></robot>)",
      Box{{Eigen::Matrix3d::Identity(), {0, 0.1 + 0.05 + gap, 0}}, {0.1, 0.05, 0.3}}, whose, 0.03);
  REQUIRE(robot.self_pairs().size() == 1);
  return {"beside its mast", robot, "", {}, {-0.2, 0}, {{0.2, 0}}, {}};
}

/// Below a plate, whose lower side is `gap` metres above the forearm, and raised beside it.
Problem below_a_plate(double gap, Whose whose = Whose::its_own) {
  Problem problem{.name = "below a plate",
                  .robot = approximated_arm(whose),
                  .start = {0, 0},
                  .goals = {{1.2, 0.7}}};
  const Box plate{{Eigen::Matrix3d::Identity(), {0.9, 0, 0.05 + gap + 0.05}}, {0.2, 0.2, 0.05}};
  problem.scene.obstacles = {{"plate", {plate}}};
  return problem;
}

SolveResult require_solve(const Problem& problem, const SolveSettings& settings = {}) {
  return require(solve(problem, nullptr, settings));
}

/// No exceptions at the ends of a path.
SolveSettings strict() {
  SolveSettings settings;
  settings.start_tolerance = settings.allow_at_ends = 0;
  return settings;
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

/// Name of the moving body in messages.
std::string name_of(Whose whose, const std::string& link) {
  return whose == Whose::carried ? "load" : link;
}

/// The states that the path's trajectory is in, every 10 ms.
Path timed_states(const Problem& problem, const SolveSettings& settings, const Path& path) {
  const auto limits = require(find_rate_limits(problem.robot));
  const auto timed = require(make_trajectory(problem, settings, path, limits));
  Path states;
  for (double time = 0; time < timed.duration_s(); time += 0.01) {
    states.push_back(timed.at(time).position);
  }
  return states;
}

/// Plans from or to where only the spheres touch the plate.
void check_plan_below_a_plate(const Problem& problem, const SolveSettings& settings,
                              const std::string& note) {
  const SolveResult result = require_solve(problem, settings);
  INFO(settings.planner << ", seed " << settings.plan.seed << ": " << result.plan.message);
  REQUIRE(result.plan.is_solved());
  REQUIRE(result.notes.size() == 1);
  CHECK(result.notes[0].starts_with(note));
  CHECK(result.notes[0].ends_with("; this pair is checked by exact geometry, 3 mm away"));
  const Path& path = result.plan.path;
  CHECK(least_gap(problem, path) > 1e-4);
  CHECK(is_path_free(problem.robot, checked_scene(problem, result), path, 0.01));
  CHECK_FALSE(is_path_free(problem.robot, problem.scene, path, 0.01));
  CHECK(least_gap(problem, timed_states(problem, settings, path)) > 1e-4);
}

TEST_SUITE("flow") {
  TEST_CASE("where only spheres touch, plans are checked by exact geometry") {
    for (const Whose whose : kAll) {
      Problem problem = below_a_plate(0.003, whose);
      const std::string note = ": link '" + name_of(whose, "forearm") +
                               "' touches obstacle 'plate' only with its spheres";
      for (const std::string end : {"start", "goal"}) {
        if (end == "goal") std::swap(problem.start, problem.goals[0]);
        for (const char* planner : {"rrt_connect", "rrt", "prm"}) {
          for (std::uint64_t seed = 1; seed <= 3; ++seed) {
            SolveSettings settings;
            settings.planner = planner;
            settings.plan.seed = seed;
            check_plan_below_a_plate(problem, settings, end + note);
          }
        }
      }
    }
  }

  TEST_CASE("notes tell a start in contact from where its first motion leads") {
    for (const double gap : {-0.0005, 0.0005}) {
      const std::string contact = gap < 0 ? "touches" : "is 0.5 mm from";
      Problem problem = below_a_plate(gap, Whose::carried);
      const SolveResult result = require_solve(problem);
      REQUIRE_MESSAGE(result.plan.is_solved(), result.plan.message);
      REQUIRE(result.notes.size() == 2);
      CHECK(result.notes[0] ==
            "start: 'load' " + contact + " obstacle 'plate'; the first motion leads away");
      CHECK(result.notes[1].starts_with(
          "after the first motion: link 'load' touches obstacle 'plate' only with its spheres"));
      std::swap(problem.start, problem.goals[0]);
      const SolveResult back = require_solve(problem);
      REQUIRE_MESSAGE(back.plan.is_solved(), back.plan.message);
      REQUIRE(back.notes.size() == 2);
      CHECK(back.notes[0].starts_with("goal: 'load' "));
      CHECK(back.notes[1].starts_with("before the last motion: link 'load' touches "));
    }
  }

  TEST_CASE("where links touch each other with spheres only, plans are checked by exact geometry") {
    const auto is_apart = [](const Configuration& q) { return q[1] > -0.004; };
    for (const Whose whose : kAll) {
      const Problem problem = beside_its_mast(0.004, whose);
      for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        SolveSettings settings;
        settings.plan.seed = seed;
        const SolveResult result = require_solve(problem, settings);
        INFO("seed " << seed << ": " << result.plan.message);
        REQUIRE(result.plan.is_solved());
        REQUIRE(result.notes.size() == 1);
        CHECK(result.notes[0].starts_with("start: links 'base' and '" + name_of(whose, "hand") +
                                          "' touch only with their spheres, which together stick "
                                          "out by up to "));
        CHECK(result.notes[0].ends_with("; this pair is checked by exact geometry, 4 mm apart"));
        CHECK(checked_scene(problem, result).exact_pairs.size() == 1);
        CHECK(std::ranges::all_of(result.plan.path, is_apart));
        CHECK(is_path_free(problem.robot, checked_scene(problem, result), result.plan.path, 0.01));
        CHECK_FALSE(is_path_free(problem.robot, problem.scene, result.plan.path, 0.01));
        CHECK(std::ranges::all_of(timed_states(problem, settings, result.plan.path), is_apart));
      }
    }
  }

  TEST_CASE("exact geometry that touches is refused, whoever it belongs to") {
    for (const Whose whose : kAll) {
      Problem problem = beside_its_mast(0.004, whose);
      problem.goals = {{0.2, -0.01}};
      const SolveResult refused = require_solve(problem);
      CHECK(refused.plan.status == PlanStatus::invalid_goal);
      CHECK(contains(refused.plan.message,
                     "link 'base' touches link '" + name_of(whose, "hand") + "'"));
      CHECK(contains(refused.plan.message, "the exact geometry touches, too"));
      for (const double gap : {-0.001, 0.0005}) {
        const SolveResult result = require_solve(beside_its_mast(gap, whose), strict());
        CHECK(result.plan.status == PlanStatus::invalid_start);
      }
      const std::string message =
          require_solve(below_a_plate(-0.001, whose), strict()).plan.message;
      INFO(message);
      CHECK(message.starts_with("start is in contact: link '" + name_of(whose, "forearm") +
                                "' touches obstacle 'plate' with spheres by "));
      CHECK(message.find("; the exact geometry touches, too)") != std::string::npos);
    }
  }

  TEST_CASE("a pose that is reached with touching spheres only is judged by exact geometry") {
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
    CHECK(
        result.notes[0].starts_with("goal: links 'base' and 'hand' touch only with their spheres"));
    CHECK(is_path_free(problem.robot, checked_scene(problem, result), result.plan.path, 0.01));
    const auto limits = require(find_rate_limits(problem.robot));
    CHECK(make_trajectory(problem, {}, result.plan.path, limits).has_value());
    problem.pose_goals[0].pose.translation.y() -= 0.01;
    const SolveResult refused = require_solve(problem);
    CHECK(refused.plan.status == PlanStatus::invalid_goal);
    CHECK(refused.notes.empty());
  }

  TEST_CASE("what is too close to be told from contact is refused, as ever") {
    for (const Whose whose : kAll) {
      for (const double gap : {-0.001, 0.0005}) {
        const SolveResult result = require_solve(below_a_plate(gap, whose), strict());
        CHECK(result.plan.status == PlanStatus::invalid_start);
        CHECK(result.notes.empty());
        CHECK_FALSE(result.scene.has_value());
      }
      SolveSettings settings = strict();
      settings.margin = 0.005;
      const SolveResult refused = require_solve(below_a_plate(0.003, whose), settings);
      CHECK(refused.plan.status == PlanStatus::invalid_start);
      CHECK(require_solve(below_a_plate(0.007, whose), settings).plan.is_solved());
    }
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
