// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/planner_flow.h"

namespace mneme::test {
namespace {

/// A post between two states of the straight motion along the first value.
World hidden_post() {
  return {"post", gantry(), {"", {make_ball("post", {0.02, 0.101, 0}, 0.01)}}, {}};
}

CheckerSettings wide_states() {
  CheckerSettings coarse;
  coarse.resolution = 0.5;
  return coarse;
}

}  // namespace

TEST_SUITE("flow") {
  TEST_CASE("a motion that fails verification is led round what it touches") {
    const CollisionChecker checker = make_checker(hidden_post(), wide_states());
    const Path straight = {{-1.9, 0, 0}, {1.9, 0, 0}};
    for (const bool simplify : {false, true}) {
      INFO("simplify ", simplify);
      FinishSettings settings;
      settings.simplify = simplify;
      CheckCounters counters;
      REQUIRE(find_invalid_motion(checker, straight, counters) == 0);
      Path path = straight;
      PathFinisher finish(checker, settings);
      REQUIRE(finish(path, counters) == -1);
      CHECK(find_invalid_motion(checker, path, counters) == -1);
      CHECK(path.front() == straight.front());
      CHECK(path.back() == straight.back());
      CHECK(path.size() > 2);
      CHECK(path_length(checker.robot(), path) < 3.9);
      Path again = straight;
      CHECK(PathFinisher(checker, settings)(again, counters) == -1);
      CHECK(again == path);
      CHECK(finish.describe_refused().empty());
    }
  }

  TEST_CASE("a motion through what is too large to go round is refused, by its number") {
    World world{"wall", gantry(), {"", {make_box("wall", {-0.1, -3, -3}, {0.1, 3, 3})}}, {}};
    const CollisionChecker checker = make_checker(world);
    const Path blocked = {{-1.9, 0, 0}, {-1, 0, 1}, {1, 0, 1}, {1.9, 0, 0}};
    PathFinisher finish(checker, {});
    CheckCounters counters;
    for (int i = 1; i <= 5; ++i) {
      Path path = blocked;
      CHECK(finish(path, counters) == 1);
      CHECK(path == blocked);
      CHECK(finish.has_refused_often() == (i >= 3));
    }
    CHECK(finish.describe_refused() == "; verification refused 5 paths");
  }

  TEST_CASE("paths that fail again and again are refused without shortening") {
    World world{"wall", gantry(), {"", {make_box("wall", {-0.1, -3, -3}, {0.1, 3, 3})}}, {}};
    const CollisionChecker checker = make_checker(world);
    PathFinisher finish(checker, {});
    CheckCounters counters;
    for (int i = 0; i < 5; ++i) {
      Path path = {{-1.9, 0, 0}, {-1, 1, 1}, {1, 0, 1}, {1.9, 0, 0}};
      const double before_s = finish.simplification_time_s();
      CHECK(finish(path, counters) == 1);
      CHECK((finish.simplification_time_s() > before_s) == (i < 3));
    }
    Path free = {{-1.9, 0, 0}, {-1.5, 1, 1}, {-1.9, 1, 0}};
    CHECK(finish(free, counters) == -1);
    CHECK(free.size() == 2);
  }
}

}  // namespace mneme::test
