// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "baselines/arm_cell.h"

namespace mneme::test {
namespace {

const Path kKnown = {{0.1, 0.5}, {1, 0.4}, {2, 0.6}};
const Path kDetour = {{0, 0.5}, {0.5, 2.4}, {2, 0.5}};

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a cached path is returned as it is but for its ends, whatever is in its way") {
    ArmCell cell;
    cell.remember(kKnown);
    cell.block(1.25, 2.2);
    for (const char* rival : {"cache", "cache_nearest"}) {
      const SolveResult result = cell.solve(rival);
      REQUIRE(result.plan.is_solved());
      REQUIRE(result.plan.path.size() == 3);
      CHECK(result.plan.path.front() == cell.problem.start);
      CHECK(cell.problem.robot.distance(result.plan.path[1], kKnown[1]) < 1e-6);
      CHECK(result.plan.path.back() == cell.problem.goals.front());
      CHECK(result.plan.states_checked == 0);
      CHECK(result.replay.row == cell.database.get(0)->id);
      CHECK_FALSE(cell.is_free(result.plan.path));
    }
  }

  TEST_CASE("the fastest comes first, or the nearest") {
    ArmCell cell;
    cell.remember(kKnown);
    cell.remember(kDetour);
    CHECK(cell.solve("cache").replay.row == cell.database.get(0)->id);
    CHECK(cell.solve("cache_nearest").replay.row == cell.database.get(1)->id);
  }

  TEST_CASE("a look at the scene leaves out what is blocked, and what is left is planned") {
    ArmCell cell;
    cell.remember(kKnown);
    cell.block(1.25, 2.2);
    const SolveResult planned = cell.solve("cache_checked");
    REQUIRE(planned.plan.is_solved());
    CHECK_FALSE(planned.replay.is_hit());
    CHECK(cell.is_free(planned.plan.path));
    cell.remember({{0, 0.5}, {0, 2.4}, {2, 2.4}, {2, 0.5}});
    const SolveResult cached = cell.solve("cache_checked");
    CHECK(cached.replay.row == cell.database.get(1)->id);
    CHECK(cell.is_free(cached.plan.path));
  }

  TEST_CASE("what leads the other way, or to somewhere else, is not found") {
    ArmCell cell;
    cell.remember({{2, 0.5}, {1, 0.4}, {0, 0.5}});
    cell.remember({{0, 0.5}, {1, 0.5}});
    const SolveResult result = cell.solve("cache");
    CHECK_FALSE(result.replay.is_hit());
    CHECK(result.plan.is_solved());
    CHECK(cell.is_free(result.plan.path));
  }

  TEST_CASE("what was planned under other constraints is not found") {
    ArmCell cell;
    cell.remember(kKnown);
    cell.problem.constraints = {{"link_2", Vec3::UnitZ(), Vec3::UnitZ(), 0.2}};
    CHECK_FALSE(cell.solve("cache").replay.is_hit());
    cell.remember(kKnown);
    CHECK(cell.solve("cache").replay.row == cell.database.get(1)->id);
  }

  TEST_CASE("ends outside of limits are refused as by a plan") {
    ArmCell cell;
    cell.remember(kKnown);
    cell.problem.goals.front() = {2, 9};
    for (const char* rival : {"cache", "cache_checked", "ert_connect"}) {
      INFO(rival);
      CHECK(cell.solve(rival).plan.status == PlanStatus::invalid_goal);
    }
  }

  TEST_CASE("errors are those of a plan") {
    ArmCell cell;
    cell.settings.lambda = 2;
    CHECK_FALSE(
        find_rival("cache")->solve(cell.problem, &cell.database, cell.settings).has_value());
    CHECK_FALSE(
        find_rival("ert_connect")->solve(cell.problem, &cell.database, cell.settings).has_value());
  }
}

}  // namespace mneme::test
