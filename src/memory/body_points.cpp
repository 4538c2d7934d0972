// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/body_points.h"

#include "mneme/primitive.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace mneme::internal {
namespace {

int joint_in_group(const Robot& robot, int joint) {
  const auto found = std::ranges::find(robot.group(), joint);
  return found == robot.group().end() ? -1 : static_cast<int>(found - robot.group().begin());
}

/// Per link the joints of the group between it and the root, root first.
std::vector<std::vector<int>> moving_joints(const Robot& robot) {
  std::vector<std::vector<int>> joints(robot.links().size());
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const int joint = robot.links()[i].parent_joint;
    if (joint < 0) continue;
    const int parent = robot.joints()[static_cast<std::size_t>(joint)].parent_link;
    joints[i] = joints[static_cast<std::size_t>(parent)];
    const int index = joint_in_group(robot, joint);
    if (index >= 0) joints[i].push_back(index);
  }
  return joints;
}

std::vector<Sphere> balls(const Link& link) {
  std::vector<Sphere> result = link.spheres;
  for (const Capsule& capsule : link.capsules) {
    const double length = (capsule.b - capsule.a).norm();
    const int steps = std::max(1, static_cast<int>(std::ceil(length / capsule.radius)));
    for (int i = 0; i <= steps; ++i) {
      result.push_back({capsule.a + (capsule.b - capsule.a) * i / steps, capsule.radius});
    }
  }
  return result;
}

}  // namespace

std::vector<bool> arm_links(const Robot& robot) {
  const SymmetricJoints symmetric = find_symmetric_joints(robot);
  const int ignored = symmetric.turn >= 0 ? symmetric.lift : -1;
  std::vector<bool> result;
  for (const std::vector<int>& joints : moving_joints(robot)) {
    result.push_back(std::ranges::any_of(joints, [&](int joint) { return joint != ignored; }));
  }
  return result;
}

std::vector<BodyPoint> body_points(const Robot& robot) {
  const std::vector<bool> is_arm = arm_links(robot);
  const std::vector<std::vector<int>> joints = moving_joints(robot);
  std::vector<BodyPoint> points;
  for (std::size_t i = 0; i < is_arm.size(); ++i) {
    if (!is_arm[i]) continue;
    for (const Sphere& ball : balls(robot.links()[i])) {
      points.push_back({static_cast<int>(i), ball.center, ball.radius, joints[i]});
    }
  }
  return points;
}

Eigen::Matrix3Xd jacobian(const Robot& robot, std::span<const Transform> poses,
                          const BodyPoint& point, const Vec3& center) {
  Eigen::Matrix3Xd result = Eigen::Matrix3Xd::Zero(3, robot.joint_count());
  for (const int index : point.joints) {
    const Joint& joint = robot.group_joint(index);
    const Transform& pose = poses[static_cast<std::size_t>(joint.child_link)];
    const Vec3 axis = pose.rotation * joint.axis;
    result.col(index) =
        joint.type == JointType::prismatic ? axis : Vec3(axis.cross(center - pose.translation));
  }
  return result;
}

}  // namespace mneme::internal
