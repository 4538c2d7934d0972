// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/statistics.h"

#include "support/planar_memory.h"

#include <doctest/doctest.h>

namespace mneme::test {
namespace {

/// A run on an arm that is free to go straight from start to goal.
struct FreeRun {
  Problem problem{.name = "free", .robot = planar_arm({1, 1}), .start = {0, 0}, .goals = {{1, 1}}};
  CollisionChecker checker = CollisionChecker::make(problem.robot, problem.scene).value();
  SolveSettings settings;
  SolveResult result;

  FreeRun() {
    settings.plan.timeout_s = 2;
    result.plan.status = PlanStatus::solved;
    result.plan.path = {problem.start, problem.goals[0]};
    result.plan.planning_time_s = 0.5;
    result.gl.retrieval_time_s = 0.1;
    result.gl.learning_time_s = 0.2;
    result.total_time_s = 0.6;
  }
  [[nodiscard]] BenchmarkRow row() const { return make_row(problem, settings, result, checker); }
};

TEST_SUITE("unit") {
  TEST_CASE("The planning time holds retrieval and learning once") {
    const BenchmarkRow row = FreeRun().row();
    CHECK(row.planning_time_s == 0.5);
    CHECK(row.retrieval_time_s == 0.1);
    CHECK(row.learning_time_s == 0.2);
    CHECK(is_success(row));
    CHECK(row.path_length == doctest::Approx(std::sqrt(2.0)));
  }

  TEST_CASE("A path that comes after the time limit is a time-out at the limit") {
    FreeRun run;
    run.result.plan.planning_time_s = 2.0001;
    const BenchmarkRow row = run.row();
    CHECK(row.status == PlanStatus::timeout);
    CHECK_FALSE(row.is_solved);
    CHECK_FALSE(row.is_path_valid);
    CHECK(row.planning_time_s == 2);
    CHECK(row.path_length == 0);
    run.result.plan.planning_time_s = 2;
    CHECK(is_success(run.row()));
  }

  TEST_CASE("A path that does not end at a goal is solved and not valid") {
    FreeRun run;
    run.result.plan.path.back() = {1, 0.9};
    const BenchmarkRow row = run.row();
    CHECK(row.is_solved);
    CHECK_FALSE(is_success(row));
  }
}

}  // namespace

}  // namespace mneme::test

namespace mneme {
namespace {

using test::contains;

TEST_SUITE("unit") {
  TEST_CASE("The machine is told by its processor, threads and system, on one line") {
    const std::string text = describe_machine();
    CHECK(contains(text, " hardware threads, "));
    CHECK(contains(text, "Linux "));
    CHECK(!contains(text, "\n"));
    CHECK(describe_build().find("mneme " + std::string(version())) == 0);
  }
}

}  // namespace

}  // namespace mneme
