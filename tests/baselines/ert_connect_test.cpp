// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "baselines/arm_cell.h"

namespace mneme::test {
namespace {

/// Past the wall of ArmCell::block, with the arm bent.
const Path kBent = {{0.1, 0.5}, {0.1, 2.2}, {2, 2.2}, {2, 0.6}};

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a remembered path that fits once it is moved to the ends is the plan") {
    ArmCell cell;
    cell.settings.plan.simplify = false;
    cell.remember(kBent);
    cell.block(1.25, 2.2);
    for (int turn = 0; turn < 2; ++turn) {
      const SolveResult result = cell.solve("ert_connect");
      REQUIRE(result.plan.is_solved());
      CHECK(result.plan.iterations == 0);
      CHECK(result.plan.path.size() == 51);
      CHECK(result.plan.path.front() == cell.problem.start);
      CHECK(result.plan.path.back() == cell.problem.goals.front());
      CHECK(cell.is_free(result.plan.path));
      // The same path serves the way back.
      std::swap(cell.problem.start, cell.problem.goals.front());
    }
  }

  TEST_CASE("where it is blocked its pieces lead round, always the same way") {
    ArmCell cell;
    cell.remember({{0, 0.5}, {2, 0.5}});
    cell.block(1.25, 2.2);
    const SolveResult result = cell.solve("ert_connect");
    REQUIRE(result.plan.is_solved());
    CHECK(result.plan.iterations > 0);
    CHECK(result.plan.nodes > 2);
    CHECK(cell.is_free(result.plan.path));
    CHECK(cell.solve("ert_connect").plan.path == result.plan.path);
  }

  TEST_CASE("of several goals it plans to the one of the most similar path") {
    ArmCell cell;
    cell.problem.goals = {{1, 2}, {2, 0.5}};
    cell.remember(kBent);
    const SolveResult result = cell.solve("ert_connect");
    REQUIRE(result.plan.is_solved());
    CHECK(result.plan.path.back() == Configuration{2, 0.5});
  }

  TEST_CASE("an empty memory is the straight way") {
    ArmCell cell;
    const SolveResult result = cell.solve("ert_connect");
    REQUIRE(result.plan.is_solved());
    CHECK(result.plan.iterations == 0);
    CHECK(result.plan.path.size() == 2);
  }

  TEST_CASE("ends in contact are refused, and limits end the search") {
    ArmCell cell;
    cell.problem.scene = make_circle_scene("cell", {{0, 0.4, 0.1}});
    cell.settings.plan.max_iterations = 50;
    const SolveResult limited = cell.solve("ert_connect");
    CHECK(limited.plan.status == PlanStatus::iteration_limit);
    CHECK(limited.plan.iterations == 50);
    cell.problem.scene = make_circle_scene("cell", {{1, 0, 0.1}});
    CHECK(cell.solve("ert_connect").plan.status == PlanStatus::invalid_start);
  }
}

}  // namespace mneme::test
