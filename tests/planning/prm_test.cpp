// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/planner_flow.h"

namespace mneme::test {

TEST_SUITE("flow") {
  TEST_CASE("prm solves small worlds with paths that survive an exact check") {
    check_solves_small_worlds(prm);
  }
  TEST_CASE("prm answers random queries with paths that survive an exact check") {
    check_solves_random_queries(prm);
  }
  TEST_CASE("prm reaches whichever goal can be reached") { check_reaches_any_goal(prm); }
  TEST_CASE("prm is done at once where the start is a goal") { check_start_may_be_goal(prm); }
  TEST_CASE("prm takes the shorter way round for continuous joints only") {
    check_takes_the_shorter_way_round(prm);
  }
  TEST_CASE("prm draws exactly as many configurations as it may") {
    check_iteration_limit_is_exact(prm);
  }
  TEST_CASE("prm holds no more nodes than it may") { check_node_limit_is_kept(prm); }
  TEST_CASE("prm keeps its time limit") { check_time_limit_is_kept(prm); }
  TEST_CASE("prm keeps its time limit with steps of any length") {
    check_tiny_range_keeps_the_time_limit(prm);
  }
  TEST_CASE("prm without time finds nothing, not even what is in sight") {
    check_zero_time_limit(prm);
  }
  TEST_CASE("prm stops soon after another thread cancels it") { check_can_be_cancelled(prm); }
  TEST_CASE("prm refuses bad starts and goals and says why") { check_refuses_bad_queries(prm); }
  TEST_CASE("prm clamps and wraps starts and goals") { check_clamps_rounding_errors(prm); }
  TEST_CASE("prm repeats itself with the same seed and not with others") {
    check_is_repeatable(prm);
  }
  TEST_CASE("prm returns no path that verification would refuse") {
    check_verification_catches_tunnelling(prm);
  }
  TEST_CASE("prm turns by half a turn on the side that is free") { check_half_turns(prm); }
  TEST_CASE("prm that verifies continuously returns nothing that touches between states") {
    check_continuous_verification(prm);
  }
  TEST_CASE("prm goes where its samples lead it") { check_samples_lead_the_way(prm, 800); }
  TEST_CASE("prm tries at least one neighbour") {
    const World world = small_worlds().front();
    PlanSettings settings = patient_settings();
    settings.neighbours = 0;
    check_solution(world, make_checker(world), run(prm, world, settings));
  }
  TEST_CASE("prm that is cancelled before it begins adds none of its many goals") {
    World world = boxed_goal();
    for (int i = 1; i < 500; ++i) world.query.goals.push_back({0.5, 0, 0.0002 * i});
    const std::atomic<bool> is_cancelled = true;
    PlanSettings settings = patient_settings();
    settings.cancel = &is_cancelled;
    const PlanResult result = run(prm, world, settings);
    CHECK(result.status == PlanStatus::cancelled);
    CHECK(result.nodes == 1);  // the start
    CHECK(result.motions_checked == 0);
  }
  TEST_CASE("prm reports what became of every draw") { check_reports_every_draw(prm); }
  TEST_CASE("prm does the same when it is watched, and shows its edges") {
    check_can_be_watched(prm, 0);
  }
}

}  // namespace mneme::test
