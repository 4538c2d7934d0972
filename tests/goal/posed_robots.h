// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Robots, and poses that they can reach because a configuration has them.
#pragma once

#include "mneme/spheres.h"
#include "mneme/goal.h"

#include "support/lifting_arm.h"
#include "support/support.h"

#include <algorithm>
#include <string>

namespace mneme::test {

inline Robot shipped_robot(const std::string& name) {
  return require(load_approximated_robot(source_file("robots/" + name + ".urdf"))).robot;
}

inline const std::string kHand = "panda_hand";
inline const Configuration kReady = {0, -0.785, 0, -2.356, 0, 1.571, 0.785};

/// Where `link` is at `q`.
inline PoseGoal pose_at(const Robot& robot, const std::string& link, const Configuration& q) {
  const auto found = std::ranges::find(robot.links(), link, &Link::name);
  REQUIRE(found != robot.links().end());
  PoseGoal goal;
  goal.link = link;
  goal.pose = robot.link_poses(q)[static_cast<std::size_t>(found - robot.links().begin())];
  return goal;
}

/// A lift, a continuous turn, a shoulder, an elbow that the forearm's twist follows, and a wrist of
/// three joints; a second arm of one joint beside it.
inline Robot odd_arm() {
  Robot::Parts parts;
  parts.name = "odd";
  parts.allowed_pairs.emplace();
  parts.links.push_back({.name = "base"});
  const auto hang = [&](int parent, JointType type, const Vec3& at, const Vec3& axis, double most) {
    hang_link(parts, parent, joint_at(type, at, axis, -most, most), {{Vec3(0.05, 0, 0), 0.03}}, {});
  };
  hang(0, JointType::prismatic, Vec3(0, 0, 0.5), Vec3::UnitZ(), 0.4);
  hang(1, JointType::continuous, Vec3(0, 0, 0.1), Vec3::UnitZ(), kPi);
  hang(2, JointType::revolute, Vec3(0.1, 0, 0), Vec3(0, 0.6, 0.8), 2);
  hang(3, JointType::revolute, Vec3(0.5, 0, 0), -Vec3::UnitY(), 2.4);
  hang(4, JointType::revolute, Vec3(0.2, 0, 0), Vec3::UnitX(), 3);
  parts.joints.back().mimic = Mimic{3, -0.5, 0.2};
  hang(5, JointType::revolute, Vec3(0.2, 0, 0), Vec3::UnitZ(), 2);
  hang(6, JointType::revolute, Vec3(0, 0, 0), Vec3::UnitY(), 2);
  hang(7, JointType::revolute, Vec3(0.1, 0, 0), Vec3::UnitX(), 2 * kPi);
  hang(1, JointType::revolute, Vec3(0, 0.3, 0), Vec3::UnitX(), 1);
  return robot_of(parts);
}
inline const std::string kOddHand = "link_8";

}  // namespace mneme::test
