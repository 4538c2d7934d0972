// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/space.h"

#include "support/support.h"

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("the space of a robot is its hash and its number of joints") {
    const Robot arm = planar8();
    const ExperienceSpace space = make_space(arm);
    CHECK(space.robot_name == arm.name());
    CHECK(space.robot_hash == arm.hash());
    CHECK(space.joint_count == 8);
  }

  TEST_CASE("spaces are the same but for the robot's name, and refusals describe both") {
    const ExperienceSpace space{"arm", "0123456789abcdef", 3};
    ExperienceSpace renamed = space;
    renamed.robot_name = "other arm";
    CHECK(internal::is_same_space(space, renamed));
    std::vector<ExperienceSpace> others(2, space);
    others[0].robot_hash = "f123456789abcdef";
    others[1].joint_count = 4;
    for (const ExperienceSpace& other : others) {
      CHECK(!internal::is_same_space(space, other));
      const Error error = internal::refuse_space("a.db", space, other).value();
      CHECK(error.code == ErrorCode::wrong_robot);
      CHECK(error.message == "a.db: holds experience of " + internal::describe(space) +
                                 "; expected that of " + internal::describe(other));
    }
  }
}

}  // namespace mneme::test
