// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/kinematics.h"

#include "base/as_index.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace mneme::internal {

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

std::vector<double> joint_values(std::span<const Joint> joints, std::span<const int> group,
                                 std::span<const double> q) {
  assert(q.size() == group.size());
  std::vector<double> values(joints.size());
  std::ranges::transform(joints, values.begin(), &Joint::fixed_value);
  for (std::size_t i = 0; i < group.size(); ++i) values[as_index(group[i])] = q[i];
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const std::optional<Mimic>& mimic = joints[i].mimic;
    if (!mimic) continue;
    values[i] = mimic->multiplier * values[as_index(mimic->joint)] + mimic->offset;
  }
  return values;
}

std::vector<Transform> forward_kinematics(std::span<const Joint> joints, std::span<const int> group,
                                          std::span<const double> q) {
  const std::vector<double> values = joint_values(joints, group, q);
  std::vector<Transform> poses(joints.size() + 1);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const Joint& joint = joints[i];
    const Transform& parent = poses[as_index(joint.parent_link)];
    poses[as_index(joint.child_link)] = parent * joint.origin * joint_motion(joint, values[i]);
  }
  return poses;
}

std::vector<bool> find_moving(std::span<const Joint> joints, std::span<const int> group) {
  std::vector<bool> is_moving(joints.size(), false);
  for (const int joint : group) is_moving[as_index(joint)] = true;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const std::optional<Mimic>& mimic = joints[i].mimic;
    if (mimic && mimic->multiplier != 0) is_moving[i] = is_moving[as_index(mimic->joint)];
  }
  return is_moving;
}

std::vector<bool> find_moving_links(const Robot& robot) {
  const std::vector<bool> is_driven = find_moving(robot.joints(), robot.group());
  std::vector<bool> is_moving(robot.links().size(), false);
  for (std::size_t i = 0; i < robot.joints().size(); ++i) {
    const Joint& joint = robot.joints()[i];
    is_moving[as_index(joint.child_link)] = is_driven[i] || is_moving[as_index(joint.parent_link)];
  }
  return is_moving;
}

std::vector<int> find_bodies(std::span<const Joint> joints, std::span<const int> group) {
  const std::vector<bool> is_moving = find_moving(joints, group);
  std::vector<int> bodies(joints.size() + 1, 0);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    bodies[as_index(joints[i].child_link)] =
        is_moving[i] ? joints[i].child_link : bodies[as_index(joints[i].parent_link)];
  }
  return bodies;
}

std::vector<int> joints_to(const Robot& robot, int link) {
  std::vector<int> joints;
  for (int i = robot.links()[as_index(link)].parent_joint; i >= 0;) {
    joints.push_back(i);
    i = robot.links()[as_index(robot.joints()[as_index(i)].parent_link)].parent_joint;
  }
  return joints;
}

std::optional<Drive> find_drive(const Robot& robot, int joint) {
  const Mimic drive = robot.joints()[as_index(joint)].mimic.value_or(Mimic{joint, 1, 0});
  const auto found = std::ranges::find(robot.group(), drive.joint);
  if (found == robot.group().end() || drive.multiplier == 0) return std::nullopt;
  return Drive{static_cast<int>(found - robot.group().begin()), drive.multiplier, drive.offset};
}

namespace {

constexpr double kPlaneTolerance = 1e-9;

bool is_along_z(const Vec3& direction) { return direction.head<2>().norm() < kPlaneTolerance; }

bool turns_about_z(const Joint& joint, const Transform& X_root_child) {
  // The motion of a joint about z leaves the z axis of its frame, so the child's frame serves.
  return is_turning(joint) && is_along_z(joint.axis) && is_along_z(X_root_child.rotation.col(2));
}

bool lies_in_plane(const Link& link, const Transform& X_root_link) {
  const auto is_in_plane = [&](const Vec3& p) {
    return std::abs((X_root_link * p).z()) < kPlaneTolerance;
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
    const Transform& child = poses[as_index(joints[i].child_link)];
    if (is_moving[i] && !turns_about_z(joints[i], child)) return false;
  }
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (!lies_in_plane(links[i], poses[i])) return false;
  }
  return true;
}

namespace {

double farthest_slide(const Robot& robot, const Joint& joint) {
  if (joint.mimic) {
    const double followed = farthest_slide(robot, robot.joints()[as_index(joint.mimic->joint)]);
    return std::abs(joint.mimic->multiplier) * followed + std::abs(joint.mimic->offset);
  }
  return std::max({std::abs(joint.lower), std::abs(joint.upper), std::abs(joint.fixed_value)});
}

}  // namespace

bool has_shapes(const Link& link) { return !link.spheres.empty() || !link.capsules.empty(); }

std::vector<Capsule> shapes_of(const Link& link) { return shapes_of(link, {}); }

std::vector<Capsule> shapes_of(const Link& link, const Transform& X_WL) {
  std::vector<Capsule> shapes;
  shapes.reserve(link.spheres.size() + link.capsules.size());
  for (const Sphere& sphere : link.spheres) {
    shapes.push_back(moved({sphere.center, sphere.center, sphere.radius}, X_WL));
  }
  for (const Capsule& capsule : link.capsules) shapes.push_back(moved(capsule, X_WL));
  return shapes;
}

Capsule moved(const Capsule& capsule, const Transform& X_WL) {
  const Vec3 a = X_WL * capsule.a;
  return {a, capsule.a == capsule.b ? a : X_WL * capsule.b, capsule.radius};
}

Sphere bound_of(std::span<const Capsule> shapes) {
  if (shapes.empty()) return {};
  Vec3 least = shapes.front().a;
  Vec3 most = least;
  for (const Capsule& shape : shapes) {
    least = least.cwiseMin(shape.a).cwiseMin(shape.b);
    most = most.cwiseMax(shape.a).cwiseMax(shape.b);
  }
  Sphere bound{0.5 * (least + most), 0};
  for (const Capsule& shape : shapes) {
    const double reach = std::max((shape.a - bound.center).norm(), (shape.b - bound.center).norm());
    bound.radius = std::max(bound.radius, reach + shape.radius);
  }
  return bound;
}

double farthest_reach(const Robot& robot) {
  double most = 0;
  for (int index = 0; index < std::ssize(robot.links()); ++index) {
    const Link& link = robot.links()[as_index(index)];
    if (!has_shapes(link)) continue;
    const Sphere bound = bound_of(shapes_of(link));
    double reach = bound.center.norm() + bound.radius;
    for (const int i : joints_to(robot, index)) {
      const Joint& joint = robot.joints()[as_index(i)];
      reach += joint.origin.translation.norm();
      if (joint.type == JointType::prismatic) reach += farthest_slide(robot, joint);
    }
    most = std::max(most, reach);
  }
  return most;
}

}  // namespace mneme::internal
