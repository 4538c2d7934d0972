// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/planner_flow.h"

namespace mneme::test {

TEST_SUITE("flow") {
  TEST_CASE("rrt_connect solves small worlds with paths that survive an exact check") {
    check_solves_small_worlds(rrt_connect);
  }
  TEST_CASE("rrt_connect answers random queries with paths that survive an exact check") {
    check_solves_random_queries(rrt_connect);
  }
  TEST_CASE("rrt_connect reaches whichever goal can be reached") {
    check_reaches_any_goal(rrt_connect);
  }
  TEST_CASE("rrt_connect is done at once where the start is a goal") {
    check_start_may_be_goal(rrt_connect);
  }
  TEST_CASE("rrt_connect takes the shorter way round for continuous joints only") {
    check_takes_the_shorter_way_round(rrt_connect);
  }
  TEST_CASE("rrt_connect draws exactly as many configurations as it may") {
    check_iteration_limit_is_exact(rrt_connect);
  }
  TEST_CASE("rrt_connect holds no more nodes than it may") {
    check_node_limit_is_kept(rrt_connect);
  }
  TEST_CASE("rrt_connect keeps its time limit") { check_time_limit_is_kept(rrt_connect); }
  TEST_CASE("rrt_connect keeps its time limit with steps of any length") {
    check_tiny_range_keeps_the_time_limit(rrt_connect);
  }
  TEST_CASE("rrt_connect without time finds nothing, not even what is in sight") {
    check_zero_time_limit(rrt_connect);
  }
  TEST_CASE("rrt_connect stops soon after another thread cancels it") {
    check_can_be_cancelled(rrt_connect);
  }
  TEST_CASE("rrt_connect refuses bad starts and goals and says why") {
    check_refuses_bad_queries(rrt_connect);
  }
  TEST_CASE("rrt_connect clamps and wraps starts and goals") {
    check_clamps_rounding_errors(rrt_connect);
  }
  TEST_CASE("rrt_connect repeats itself with the same seed and not with others") {
    check_is_repeatable(rrt_connect);
  }
  TEST_CASE("rrt_connect returns no path that verification would refuse") {
    check_verification_catches_tunnelling(rrt_connect);
  }
  TEST_CASE("rrt_connect turns by half a turn on the side that is free") {
    check_half_turns(rrt_connect);
  }
  TEST_CASE("rrt_connect that verifies continuously returns nothing that touches between states") {
    check_continuous_verification(rrt_connect);
  }
  TEST_CASE("rrt_connect goes where its samples lead it") {
    check_samples_lead_the_way(rrt_connect, 6000);
  }
  TEST_CASE("rrt_connect reports what became of every draw") {
    check_reports_every_draw(rrt_connect);
  }
  TEST_CASE("rrt_connect does the same when it is watched, and shows the edges of both trees") {
    check_can_be_watched(rrt_connect, 1);
  }
}

}  // namespace mneme::test
