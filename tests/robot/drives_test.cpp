// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/kinematics.h"
#include "robot/small_robots.h"

#include <vector>

namespace mneme::test {
namespace {

using internal::find_drive;

TEST_SUITE("unit") {
  TEST_CASE("joints from a link to the root") {
    const Robot robot = require_robot(make_chain(3));
    CHECK(internal::joints_to(robot, 3) == std::vector<int>{2, 1, 0});
    CHECK(internal::joints_to(robot, 0).empty());
  }

  TEST_CASE("joints are driven by the group, itself or through one that they follow") {
    Robot::Parts parts = make_chain(6);
    parts.joints[2].mimic = follow(1, -0.5, 0.2);
    parts.joints[3].mimic = follow(0, 2, 0.1);
    parts.joints[4].mimic = follow(1, 0, 0.3);
    parts.joints[5].type = JointType::fixed;
    const Robot robot = require_robot(parts, plan_for({"j2"}, {{"j1", 0.4}}));
    const std::vector<double> q = {0.7};
    const auto values = internal::joint_values(robot.joints(), robot.group(), q);
    for (const int joint : {1, 2}) {
      const auto drive = require(find_drive(robot, joint));
      CHECK(drive.joint == 0);
      CHECK(drive.rate * q[0] + drive.offset == values[static_cast<std::size_t>(joint)]);
    }
    for (const int joint : {0, 3, 4, 5}) {
      CHECK_FALSE(find_drive(robot, joint).has_value());
      const auto i = static_cast<std::size_t>(joint);
      CHECK(robot.joints()[i].fixed_value == values[i]);
    }
  }
}

}  // namespace
}  // namespace mneme::test
