// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/planarity.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "robot/kinematics.h"
#include "robot/mimic.h"

namespace mneme::internal {
namespace {

constexpr double kTolerance = 1e-9;

bool is_along_z(const Vec3& direction) { return direction.head<2>().norm() < kTolerance; }

bool turns_about_z(const Joint& joint, const Transform& X_root_child) {
  const bool is_turning = joint.type == JointType::revolute || joint.type == JointType::continuous;
  // The motion of a joint about z leaves the z axis of its frame, so the child's frame serves.
  return is_turning && is_along_z(joint.axis) && is_along_z(X_root_child.rotation.col(2));
}

bool lies_in_plane(const Link& link, const Transform& X_root_link) {
  const auto is_in_plane = [&](const Vec3& p) {
    return std::abs((X_root_link * p).z()) < kTolerance;
  };
  return std::ranges::all_of(link.spheres,
                             [&](const Sphere& s) { return is_in_plane(s.center); }) &&
         std::ranges::all_of(
             link.capsules, [&](const Capsule& c) { return is_in_plane(c.a) && is_in_plane(c.b); });
}

}  // namespace

bool moves_in_plane(std::span<const Link> links, std::span<const Joint> joints,
                    std::span<const int> group) {
  const std::vector<double> zero(group.size(), 0.0);
  const std::vector<Transform> poses = forward_kinematics(joints, group, zero);
  const std::vector<bool> is_moving = find_moving(joints, group);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const Transform& child = poses[static_cast<std::size_t>(joints[i].child_link)];
    if (is_moving[i] && !turns_about_z(joints[i], child)) return false;
  }
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (!lies_in_plane(links[i], poses[i])) return false;
  }
  return true;
}

}  // namespace mneme::internal
