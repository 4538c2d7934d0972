// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/robot_facts.h"
#include "robot/small_robots.h"
#include "support/support.h"

#include <utility>
#include <vector>

namespace mneme {
namespace {

using Pairs = std::vector<std::pair<int, int>>;

Pairs pairs_of(const Robot& robot) {
  return {robot.self_pairs().begin(), robot.self_pairs().end()};
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("in a chain all links but neighbours are checked") {
    CHECK(pairs_of(test::require_robot(test::make_chain(3))) == Pairs{{0, 2}, {0, 3}, {1, 3}});
  }

  TEST_CASE("links without shapes are in no pair") {
    Robot::Parts parts = test::make_chain(3);
    parts.links[0].spheres.clear();
    CHECK(pairs_of(test::require_robot(parts)) == Pairs{{1, 3}});
  }

  TEST_CASE("a fixed joint welds its links into one body") {
    Robot::Parts parts = test::make_chain(4);
    parts.joints[1].type = JointType::fixed;
    // Bodies {0}, {1, 2}, {3}, {4}.
    CHECK(pairs_of(test::require_robot(parts)) == Pairs{{0, 3}, {0, 4}, {1, 4}, {2, 4}});
  }

  TEST_CASE("a joint outside the group welds its links into one body") {
    RobotOptions options;
    options.joints = {"j1", "j3", "j4"};
    const Robot robot = test::require_robot(test::make_chain(4), options);
    CHECK(pairs_of(robot) == Pairs{{0, 3}, {0, 4}, {1, 4}, {2, 4}});
  }

  TEST_CASE("joints that follow the group move their links too") {
    Robot::Parts parts = test::make_chain(4);
    parts.joints[1].mimic = test::follow(0);
    CHECK(pairs_of(test::require_robot(parts, test::plan_for({"j1"}))) ==
          Pairs{{0, 2}, {0, 3}, {0, 4}});
    parts.joints[1].mimic = test::follow(0, 0);
    CHECK(pairs_of(test::require_robot(parts, test::plan_for({"j1"}))).empty());
  }

  TEST_CASE("with a list of allowed pairs neighbours are checked like others") {
    Robot::Parts parts = test::make_chain(3);
    parts.joints[2].type = JointType::fixed;
    parts.allowed_pairs.emplace();
    CHECK(pairs_of(test::require_robot(parts)) == Pairs{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}});
    parts.allowed_pairs->emplace_back("l2", "l0");
    CHECK(pairs_of(test::require_robot(parts)) == Pairs{{0, 1}, {0, 3}, {1, 2}, {1, 3}});
  }

  TEST_CASE("links on two branches are checked against each other") {
    Robot::Parts parts = test::make_chain(2);
    parts.joints[1].parent_link = 0;
    CHECK(pairs_of(test::require_robot(parts)) == Pairs{{1, 2}});
  }
}

}  // namespace mneme
