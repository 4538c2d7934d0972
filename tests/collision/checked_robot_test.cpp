// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "collision/make_tables.h"
#include "collision/random_worlds.h"

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("copies of a robot share their tables, other robots do not, even equal ones") {
    const Robot robot = planar8();
    const Robot copy = robot;  // NOLINT(performance-unnecessary-copy-initialization)
    const auto own = internal::share_checked_robot(robot);
    const auto of_copy = internal::share_checked_robot(copy);
    const auto of_other = internal::share_checked_robot(planar8());
    REQUIRE(own.has_value());
    REQUIRE(of_copy.has_value());
    REQUIRE(of_other.has_value());
    CHECK(*own == *of_copy);
    CHECK(*own != *of_other);
    CHECK((*own)->tables.joint_count == 8);
  }

  TEST_CASE("tables are let go with the last copy of their robot") {
    std::weak_ptr<const internal::CheckedRobot> tables;
    {
      const Robot robot = planar8();
      tables = *internal::share_checked_robot(robot);
      CHECK(!tables.expired());
    }
    // The next robot clears the place of those that are gone.
    CHECK(internal::share_checked_robot(planar8()).has_value());
    CHECK(tables.expired());
  }

  TEST_CASE("a robot with too many joints is refused each time") {
    Robot::Parts parts;
    parts.name = "snake";
    parts.links.push_back({"link0", -1, {}, {}, {}});
    for (int i = 1; i <= 80; ++i) {
      parts.links.push_back({"link" + std::to_string(i), -1, {}, {}, {}});
      Joint joint;
      joint.name = "joint" + std::to_string(i);
      joint.type = JointType::continuous;
      joint.parent_link = i - 1;
      joint.child_link = i;
      parts.joints.push_back(joint);
    }
    const auto robot = make_robot(parts);
    REQUIRE(robot.has_value());
    for (int i = 0; i < 2; ++i) {
      const auto refused = internal::share_checked_robot(*robot);
      REQUIRE(!refused.has_value());
      CHECK(refused.error().code == ErrorCode::unsupported);
    }
  }
}

}  // namespace mneme::test
