// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Robots made of parts for the tests of this room.
#pragma once

#include "support/support.h"

#include <string>

namespace mneme::test {

inline Joint make_joint(const std::string& name, JointType type, int parent, int child) {
  Joint joint;
  joint.name = name;
  joint.type = type;
  joint.parent_link = parent;
  joint.child_link = child;
  joint.origin.translation = Vec3(1, 0, 0);
  joint.axis = Vec3::UnitZ();
  joint.lower = -2;
  joint.upper = 2;
  return joint;
}

inline Link make_link(const std::string& name) {
  Link link;
  link.name = name;
  link.spheres.push_back({Vec3(0.5, 0, 0), 0.1});
  return link;
}

/// Links l0 to l<n>, each with a sphere; joint j<i> joins l<i-1> to l<i>, is 1 m further along x
/// and turns about z.
inline Robot::Parts make_chain(int joint_count, JointType type = JointType::revolute) {
  Robot::Parts parts;
  parts.name = "chain";
  parts.links.push_back(make_link("l0"));
  for (int i = 1; i <= joint_count; ++i) {
    parts.links.push_back(make_link("l" + std::to_string(i)));
    parts.links.back().parent_joint = i - 1;
    parts.joints.push_back(make_joint("j" + std::to_string(i), type, i - 1, i));
  }
  return parts;
}

inline Robot require_robot(Robot::Parts parts, const RobotOptions& options = {}) {
  return require(make_robot(std::move(parts), options));
}

/// Options that name the joints of the group and the values of others.
inline RobotOptions plan_for(std::vector<std::string> joints,
                             std::map<std::string, double> fixed_values = {}) {
  RobotOptions options;
  options.joints = std::move(joints);
  options.fixed_values = std::move(fixed_values);
  return options;
}

inline Mimic follow(int joint, double multiplier = 1, double offset = 0) {
  return {joint, multiplier, offset};
}

/// Why there is no robot of these parts.
inline std::string refusal(const Robot::Parts& parts, const RobotOptions& options = {}) {
  const Error error = require_error(make_robot(parts, options));
  CHECK(error.code == ErrorCode::invalid);
  CHECK(contains(error.message, "robot '" + parts.name + "': "));
  return error.message;
}

}  // namespace mneme::test
