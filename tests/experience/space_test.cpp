// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/support.h"

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("the space of a robot is its hash, the decomposer's version and their sizes") {
    const Robot arm = planar8();
    const auto space = make_space(arm);
    REQUIRE(space.has_value());
    CHECK(space->robot_name == arm.name());
    CHECK(space->robot_hash == arm.hash());
    CHECK(space->decomposer == "pairs/1");
    CHECK(space->joint_count == 8);
    CHECK(space->key_size == 6);
  }

  TEST_CASE("there is no space of an unknown decomposer") {
    const auto space = make_space(planar8(), "triples");
    REQUIRE(!space.has_value());
    CHECK(space.error().code == ErrorCode::invalid);
  }
}

}  // namespace mneme::test
