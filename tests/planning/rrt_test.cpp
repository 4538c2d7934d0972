// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/planner_flow.h"

namespace mneme::test {

TEST_SUITE("flow") {
  TEST_CASE("rrt solves small worlds with paths that survive an exact check") {
    check_solves_small_worlds(rrt);
  }
  TEST_CASE("rrt answers random queries with paths that survive an exact check") {
    check_solves_random_queries(rrt);
  }
  TEST_CASE("rrt reaches whichever goal can be reached") { check_reaches_any_goal(rrt); }
  TEST_CASE("rrt is done at once where the start is a goal") { check_start_may_be_goal(rrt); }
  TEST_CASE("rrt takes the shorter way round for continuous joints only") {
    check_takes_the_shorter_way_round(rrt);
  }
  TEST_CASE("rrt draws exactly as many configurations as it may") {
    check_iteration_limit_is_exact(rrt);
  }
  TEST_CASE("rrt holds no more nodes than it may") { check_node_limit_is_kept(rrt); }
  TEST_CASE("rrt keeps its time limit") { check_time_limit_is_kept(rrt); }
  TEST_CASE("rrt keeps its time limit with steps of any length") {
    check_tiny_range_keeps_the_time_limit(rrt);
  }
  TEST_CASE("rrt without time finds nothing, not even what is in sight") {
    check_zero_time_limit(rrt);
  }
  TEST_CASE("rrt stops soon after another thread cancels it") { check_can_be_cancelled(rrt); }
  TEST_CASE("rrt refuses bad starts and goals and says why") { check_refuses_bad_queries(rrt); }
  TEST_CASE("rrt clamps and wraps starts and goals") { check_clamps_rounding_errors(rrt); }
  TEST_CASE("rrt repeats itself with the same seed and not with others") {
    check_is_repeatable(rrt);
  }
  TEST_CASE("rrt returns no path that verification would refuse") {
    check_verification_catches_tunnelling(rrt);
  }
  TEST_CASE("rrt turns by half a turn on the side that is free") { check_half_turns(rrt); }
  TEST_CASE("rrt that verifies continuously returns nothing that touches between states") {
    check_continuous_verification(rrt);
  }
  TEST_CASE("rrt goes where its samples lead it") { check_samples_lead_the_way(rrt, 800); }
  TEST_CASE("rrt reports what became of every draw") { check_reports_every_draw(rrt); }
  TEST_CASE("rrt does the same when it is watched, and shows its edges") {
    check_can_be_watched(rrt, 0);
  }
}

}  // namespace mneme::test
