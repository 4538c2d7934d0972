// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/kinematics.h"

#include <algorithm>
#include <cassert>

namespace mneme {
namespace internal {
namespace {

Transform joint_motion(const Joint& joint, double value) {
  switch (joint.type) {
    case JointType::fixed:
      return {};
    case JointType::prismatic:
      return {Eigen::Matrix3d::Identity(), value * joint.axis};
    case JointType::revolute:
    case JointType::continuous:
      return {rotation_about(joint.axis, value), Vec3::Zero()};
  }
  return {};
}

}  // namespace

std::vector<double> joint_values(std::span<const Joint> joints, std::span<const int> group,
                                 std::span<const double> q) {
  assert(q.size() == group.size());
  std::vector<double> values(joints.size());
  std::ranges::transform(joints, values.begin(), &Joint::fixed_value);
  for (std::size_t i = 0; i < group.size(); ++i) values[static_cast<std::size_t>(group[i])] = q[i];
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const std::optional<Mimic>& mimic = joints[i].mimic;
    if (!mimic) continue;
    values[i] = mimic->multiplier * values[static_cast<std::size_t>(mimic->joint)] + mimic->offset;
  }
  return values;
}

std::vector<Transform> forward_kinematics(std::span<const Joint> joints, std::span<const int> group,
                                          std::span<const double> q) {
  const std::vector<double> values = joint_values(joints, group, q);
  std::vector<Transform> poses(joints.size() + 1);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const Joint& joint = joints[i];
    const Transform& parent = poses[static_cast<std::size_t>(joint.parent_link)];
    poses[static_cast<std::size_t>(joint.child_link)] =
        parent * joint.origin * joint_motion(joint, values[i]);
  }
  return poses;
}

}  // namespace internal

std::vector<Transform> Robot::link_poses(std::span<const double> q) const {
  return internal::forward_kinematics(joints(), group(), q);
}

}  // namespace mneme
