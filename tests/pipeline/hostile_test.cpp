// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Robots and scenes that nobody would build on purpose.
#include "support/lifting_arm.h"
#include "support/planar_memory.h"

#include <cmath>
#include <limits>

namespace mneme::test {
namespace {

SolveSettings short_settings() {
  SolveSettings settings;
  settings.plan.timeout_s = 600;  // iterations end it
  settings.plan.max_iterations = 2000;
  return settings;
}

Problem problem_of(const Robot& robot, const Scene& scene, const Configuration& start,
                   const Configuration& goal) {
  return {"hostile", robot, "", scene, start, {goal}, {}};
}

/// Small boxes on a lattice around lifting_arm(), outside a ball that holds it at rest.
Scene dust(int count) {
  Scene scene{"dust", {}};
  const int side = static_cast<int>(std::ceil(std::cbrt(count)));
  for (int i = 0; std::ssize(scene.obstacles) < count; ++i) {
    const Vec3 cell(i % side, i / side % side, i / side / side);
    const Vec3 center = 1.2 * (cell - Vec3::Constant(0.5 * side)) + Vec3(0.6, 0.6, 0.6);
    if (center.norm() < 1.6) continue;
    scene.obstacles.push_back(
        {"grain" + std::to_string(i), {box_at(center, Vec3::Constant(0.01))}});
  }
  return scene;
}

TEST_SUITE("unit") {
  TEST_CASE("a robot that stands on an obstacle can plan, however close it stands") {
    const Robot robot = lifting_arm();
    // The base is a ball whose lowest point is at z = -0.1.
    for (const double gap : {1e-9, 1e-6, 9e-5, 1e-3}) {
      CAPTURE(gap);
      Scene scene = shelf_scene();
      scene.obstacles.push_back({"floor", {box_at({0, 0, -0.6 - gap}, {2, 2, 0.5})}});
      const Problem problem = problem_of(robot, scene, {0, 0, 0, 0}, {0, 0, 0.6, -0.4});
      for (const PlannerEntry& planner : planners()) {
        SolveSettings settings;
        settings.planner = planner.name;
        settings.plan.timeout_s = 600;
        CAPTURE(planner.name);
        require_solved(problem, nullptr, settings);
      }
    }
  }

  TEST_CASE("joints whose limits leave no room are planned around") {
    Robot::Parts parts = lifting_arm_parts();
    parts.joints[1].lower = parts.joints[1].upper = 0.3;
    const Robot robot = robot_of(parts);
    const Problem problem = problem_of(robot, {}, {0, 0.3, 0, 0}, {0.4, 0.3, 1, 1});
    for (const PlannerEntry& planner : planners()) {
      for (const std::string_view sampler : {"uniform", "halton"}) {
        SolveSettings settings = short_settings();
        settings.planner = planner.name;
        settings.sampler = sampler;
        const SolveResult result = require_solved(problem, nullptr, settings);
        for (const Configuration& q : result.plan.path) CHECK(q[1] == doctest::Approx(0.3));
      }
    }
    const Problem outside = problem_of(robot, {}, {0, 0.4, 0, 0}, {0.4, 0.3, 1, 1});
    CHECK(require(solve(outside, nullptr, {})).plan.status == PlanStatus::invalid_start);
  }

  TEST_CASE("an arm of one joint and one of thirty are planned for") {
    for (const int joints : {1, 30}) {
      CAPTURE(joints);
      const auto count = static_cast<std::size_t>(joints);
      const Robot robot = planar_arm(std::vector<double>(count, 4.0 / joints));
      const Scene scene = make_circle_scene("post", {{0, 3, 0.5}, {0, -3, 0.5}});
      // Before the upper post, and past it, which takes many turns of a long chain.
      for (const double angle : {1.0, 3.0}) {
        Configuration goal(count, 0.0);
        goal[0] = angle;
        const Problem problem = problem_of(robot, scene, Configuration(count, 0.0), goal);
        for (const PlannerEntry& planner : planners()) {
          SolveSettings settings = short_settings();
          settings.planner = planner.name;
          settings.plan.max_iterations = 50;
          const SolveResult result = require(solve(problem, nullptr, settings));
          INFO(planner.name, " to ", angle, ": ", result.plan.message);
          if (angle < 2) CHECK(result.plan.is_solved());
          const CollisionChecker checker = make_checker(robot, scene);
          if (result.plan.is_solved())
            CHECK(is_path_free(checker.robot(), checker.scene(), result.plan.path, 0.001));
        }
      }
    }
  }

  TEST_CASE("values that are no numbers are answers that name them, not paths") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double infinity = std::numeric_limits<double>::infinity();
    for (const double bad : {nan, infinity, -infinity, 1e300}) {
      CAPTURE(bad);
      const Robot robot = planar_arm({1, 1});
      const Problem start = problem_of(robot, {}, {0, bad}, {0, 1});
      CHECK(require(solve(start, nullptr, {})).plan.status == PlanStatus::invalid_start);
      const Problem goal = problem_of(robot, {}, {0, 0}, {0, bad});
      CHECK(require(solve(goal, nullptr, {})).plan.status == PlanStatus::invalid_goal);
      const Scene ball{"s", {{"bad ball", {Sphere{{0, bad, 0}, 1}}}}};
      const Scene box{"s", {{"bad box", {box_at({0, 9, 0}, {1, bad, 1})}}}};
      for (const Scene& scene : {ball, box}) {
        const Error refused =
            require_error(solve(problem_of(robot, scene, {0, 0}, {0, 1}), nullptr, {}));
        CHECK(contains(refused.message, "'bad b"));
      }
    }
  }

  TEST_CASE("obstacles without size are refused, and those as large as a hill are no trouble") {
    const Robot robot = planar_arm({1, 1});
    const Scene point{"s", {{"point", {Sphere{{5, 0, 0}, 0}}}}};
    CHECK(!solve(problem_of(robot, point, {0, 0}, {0, 1}), nullptr, {}).has_value());
    const Scene hill{"s", {{"hill", {Sphere{{0, -5004, 0}, 4990}}}}};
    require_solved(problem_of(robot, hill, {0, 0}, {0, 1}), nullptr, short_settings());
    const Scene around{"s", {{"hill", {Sphere{{0, -4000, 0}, 4990}}}}};
    const SolveResult within =
        require(solve(problem_of(robot, around, {0, 0}, {0, 1}), nullptr, {}));
    CHECK(within.plan.status == PlanStatus::invalid_start);
    CHECK(contains(within.plan.message, "hill"));
  }

  TEST_CASE("a hundred thousand obstacles are planned among, with memory asked or not") {
    const Robot robot = lifting_arm();
    const Problem problem = problem_of(robot, dust(100000), {0, 0, 0, 0}, {0.3, 1, 0.5, -0.4});
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", robot);
    SolveSettings settings = short_settings();
    settings.retrieve_after = 0;
    const SolveResult result = require_solved(problem, &database, settings);
    CHECK(result.gl.primitives.empty());
    settings.memory.max_gap = 3;
    CHECK(contains(require_error(solve(problem, &database, settings)).message, "max-gap"));
  }

  TEST_CASE("the margin keeps the whole path away from obstacles, its ends too") {
    const Robot robot = planar_arm({1, 1});
    const Scene scene = make_circle_scene("post", {{1.2, 1.2, 0.3}});
    const Problem problem = problem_of(robot, scene, {-0.5, 0}, {2.2, 0});
    SolveSettings settings;
    settings.plan.timeout_s = 600;
    settings.margin = 0.1;
    const SolveResult result = require_solved(problem, nullptr, settings);
    const CollisionChecker strict = make_checker(robot, scene, settings.margin);
    for (const Configuration& q : result.plan.path) CHECK(strict.contacts(q).empty());
    settings.margin = 5;
    CHECK(require(solve(problem, nullptr, settings)).plan.status == PlanStatus::invalid_start);
  }
}

}  // namespace
}  // namespace mneme::test
