// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/robot_facts.h"
#include "robot/small_robots.h"
#include "support/support.h"

#include <functional>
#include <string>
#include <vector>

namespace mneme {

TEST_SUITE("unit") {
  TEST_CASE("a joint that follows the group must turn about z too") {
    Robot::Parts parts = test::make_chain(2);
    parts.joints[1].mimic = test::follow(0);
    CHECK(test::require_robot(parts).is_planar());
    parts.joints[1].axis = Vec3::UnitX();
    CHECK_FALSE(test::require_robot(parts).is_planar());
  }

  TEST_CASE("arms that turn about z with shapes in the plane are planar") {
    CHECK(test::planar8().is_planar());
    Robot::Parts parts = test::make_chain(3);
    parts.joints[1].axis = Vec3(0, 0, -1);
    parts.joints[2].origin.rotation = rotation_from_rpy(Vec3(0, 0, 0.7));
    CHECK(test::require_robot(parts).is_planar());
  }

  TEST_CASE("whatever leaves the plane makes a robot spatial") {
    const std::vector<std::function<void(Robot::Parts&)>> changes{
        [](Robot::Parts& p) { p.links[1].spheres[0].center.z() = 1e-6; },
        [](Robot::Parts& p) { p.links[0].spheres[0].center.z() = 1e-6; },
        [](Robot::Parts& p) {
          p.links[2].capsules.push_back({Vec3(0, 0, 0), Vec3(1, 0, 1), 0.1});
        },
        [](Robot::Parts& p) { p.joints[1].axis = Vec3(0, 1e-6, 1); },
        [](Robot::Parts& p) { p.joints[0].origin.rotation = rotation_from_rpy(Vec3(1e-6, 0, 0)); },
        [](Robot::Parts& p) { p.joints[1].origin.translation.z() = 0.1; },
        [](Robot::Parts& p) { p.joints[1].type = JointType::prismatic; },
    };
    for (std::size_t i = 0; i < changes.size(); ++i) {
      CAPTURE(i);
      Robot::Parts parts = test::make_chain(3);
      changes[i](parts);
      CHECK_FALSE(test::require_robot(parts).is_planar());
    }
  }

  TEST_CASE("a lift outside the group counts with its fixed value") {
    Robot::Parts parts = test::make_chain(2);
    parts.joints[0].type = JointType::prismatic;
    RobotOptions options;
    options.joints = {"j2"};
    CHECK(test::require_robot(parts, options).is_planar());
    options.fixed_values = {{"j1", 0.5}};
    CHECK_FALSE(test::require_robot(parts, options).is_planar());
  }
}

}  // namespace mneme
