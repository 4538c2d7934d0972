// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/pipeline.h"

#include "support/planar_memory.h"

#include <atomic>

namespace mneme::test {
namespace {

/// Problems with the same ends and goals as `problem`, the obstacles moved a little in each.
std::vector<Problem> make_cell(const Problem& problem, int count) {
  Rng rng(3);
  std::vector<Problem> problems;
  for (int i = 0; i < count; ++i) {
    Problem& made = problems.emplace_back(problem);
    const Transform X{Eigen::Matrix3d::Identity(), {rng.uniform(-0.05, 0.05), 0, 0}};
    for (Obstacle& obstacle : made.scene.obstacles) {
      for (Shape& shape : obstacle.shapes) shape = transformed(X, shape);
    }
  }
  return problems;
}

ManySettings uniform_settings() {
  ManySettings settings;
  settings.solve.sampler = "uniform";
  settings.solve.plan.timeout_s = 600;
  return settings;
}

TEST_SUITE("flow") {
  TEST_CASE("Each problem has the path that it has alone, with any number of threads") {
    const auto problems = make_cell(planar_problem("threaded_b2"), 8);
    ManySettings settings = uniform_settings();
    for (const int jobs : {1, 3}) {
      settings.jobs = jobs;
      const auto solutions = require(plan_many(problems, nullptr, settings));
      REQUIRE(solutions.size() == problems.size());
      for (std::size_t i = 0; i < problems.size(); ++i) {
        const auto alone = require(solve(problems[i], nullptr, settings.solve));
        REQUIRE(solutions[i].has_value());
        CHECK(alone.plan.is_solved());
        CHECK(solutions[i]->result.plan.path == alone.plan.path);
        CHECK(solutions[i]->trajectory.empty());
      }
    }
  }

  TEST_CASE("Trajectories are sampled from start to goal") {
    const auto problems = make_cell(planar_problem("threaded_b2"), 2);
    ManySettings settings = uniform_settings();
    settings.timing.emplace().dt = 0.05;
    const auto solutions = require(plan_many(problems, nullptr, settings));
    for (const auto& solution : solutions) {
      REQUIRE(solution.has_value());
      const auto& points = solution->trajectory;
      REQUIRE(points.size() > 2);
      const Robot& robot = problems.front().robot;
      CHECK(points[1].time_s == doctest::Approx(0.05));
      CHECK(robot.distance(points.front().position, solution->result.plan.path.front()) < 1e-6);
      CHECK(robot.distance(points.back().position, solution->result.plan.path.back()) < 1e-6);
    }
  }
}

TEST_SUITE("unit") {
  TEST_CASE("A problem that cannot be planned leaves the others alone") {
    auto problems = make_cell(planar_problem("threaded_b2"), 3);
    problems[1].scene.obstacles.push_back({"flat", {Box{}}});
    const auto solutions = require(plan_many(problems, nullptr, uniform_settings()));
    CHECK(solutions[0].has_value());
    REQUIRE_FALSE(solutions[1].has_value());
    CHECK(contains(solutions[1].error().message, "flat"));
    CHECK(solutions[2].has_value());
    CHECK(plan_many({}, nullptr, uniform_settings()).value().empty());
  }

  TEST_CASE("Settings that make problems depend on each other are refused") {
    const auto problems = make_cell(planar_problem("threaded_b2"), 1);
    ManySettings settings = uniform_settings();
    settings.solve.remember_after = 0;
    CHECK(require_error(plan_many(problems, nullptr, settings)).code == ErrorCode::invalid);
  }

  TEST_CASE("Cancelling ends all problems") {
    const auto problems = make_cell(planar_problem("threaded_b2"), 4);
    const std::atomic<bool> cancel = true;
    ManySettings settings = uniform_settings();
    settings.solve.plan.cancel = &cancel;
    const auto solutions = require(plan_many(problems, nullptr, settings));
    for (const auto& solution : solutions) {
      CHECK(solution.value().result.plan.status == PlanStatus::cancelled);
    }
  }
}

}  // namespace
}  // namespace mneme::test
