// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bent_path/bent_path.h"
#include "support/turning_panda.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <numbers>

namespace mneme::test {
namespace {

/// The Panda's chain, whose last joint turns without limits.
internal::LinkChain make_chain(const TemporaryDirectory& directory) {
  write_turning_panda(directory);
  const Robot robot = require(load_robot(directory / "panda.urdf"));
  return require(internal::LinkChain::make(robot, "panda_hand"));
}

internal::JointVector state(double first, double last) {
  internal::JointVector q = internal::JointVector::Zero(7);
  q[0] = first;
  q[6] = last;
  return q;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("bent paths begin at the start and end at the changed goal") {
    for (int profile = 0; profile < internal::kBendProfiles; ++profile) {
      const internal::BentPath path =
          internal::bend({state(0, 0), state(0.5, 0.2), state(1, 1)}, profile);
      const internal::JointVector change = state(0.1, -0.1);
      CHECK(path.shares.front() == 0);
      CHECK(path.waypoint(0, change) == state(0, 0));
      CHECK(path.waypoint(path.size() - 1, change).isApprox(state(1.1, 0.9), 1e-3));
      CHECK(std::ranges::is_sorted(path.shares));
    }
  }

  TEST_CASE("long turns of continuous joints are halved, so that bent ones are unique") {
    const TemporaryDirectory directory;
    const internal::LinkChain chain = make_chain(directory);
    REQUIRE(chain.wraps(6));
    const internal::JointPath path = {state(0, 3), state(2, 3), state(2, 6)};
    const internal::JointPath parts = internal::with_short_turns(path, chain);
    REQUIRE(parts.size() == 4);
    CHECK(parts[2] == state(2, 4.5));
    CHECK(internal::has_unique_turns(chain, state(0, 3), state(2, 6)));
    CHECK_FALSE(internal::has_unique_turns(chain, state(0, 3), state(2, 6.2)));
    CHECK(internal::has_unique_turns(chain, parts[2], state(2, 6.2)));
  }

  TEST_CASE("a goal that another turn brings nearer to the start is not served") {
    const TemporaryDirectory directory;
    const internal::LinkChain chain = make_chain(directory);
    const double half = std::numbers::pi;
    const internal::BentPath path = internal::bend({state(0, 3), state(0, 6)}, 0);
    CHECK(internal::takes_nearest_turns(path, chain, state(0, 3 + half)));
    CHECK_FALSE(internal::takes_nearest_turns(path, chain, state(0, 3.2 + half)));
    // Unless the path itself goes the long way round.
    const internal::BentPath longer = internal::bend({state(0, 3), state(0, 5), state(0, 6.5)}, 0);
    CHECK(internal::takes_nearest_turns(longer, chain, state(0, 3.2 + half)));
  }
}

}  // namespace mneme::test
