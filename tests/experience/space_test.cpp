// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/space.h"

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

  TEST_CASE("spaces are the same but for the robot's name, and refusals describe both") {
    const ExperienceSpace space{"arm", "0123456789abcdef", "pairs/1", 3, 6};
    ExperienceSpace renamed = space;
    renamed.robot_name = "other arm";
    CHECK(internal::is_same_space(space, renamed));
    std::vector<ExperienceSpace> others(4, space);
    others[0].robot_hash = "f123456789abcdef";
    others[1].decomposer = "pairs/2";
    others[2].joint_count = 4;
    others[3].key_size = 7;
    for (const ExperienceSpace& other : others) {
      CHECK(!internal::is_same_space(space, other));
      const Error error = internal::refuse_space("a.db", space, other).value();
      CHECK(error.code == ErrorCode::wrong_robot);
      CHECK(error.message == "a.db: holds experience of " + internal::describe(space) +
                                 "; expected that of " + internal::describe(other));
    }
  }

  TEST_CASE("there is no space of an unknown decomposer") {
    const auto space = make_space(planar8(), "triples");
    REQUIRE(!space.has_value());
    CHECK(space.error().code == ErrorCode::invalid);
  }
}

}  // namespace mneme::test
