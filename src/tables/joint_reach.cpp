// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tables/joint_reach.h"

#include "base/as_index.h"

#include <Eigen/Core>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <vector>

namespace mneme::internal {
namespace {

constexpr int kMostBoxes = 256;

using Crossing = Linkage::Crossing;
using MovingJoint = Linkage::MovingJoint;

/// Pose of the child's frame in its parent.
Transform pose_of(const Crossing& crossing, const JointValues& values) {
  const double value = crossing.multiplier * values[crossing.joint] + crossing.offset;
  if (crossing.is_prismatic)
    return crossing.mount * Transform{Eigen::Matrix3d::Identity(), value * Vec3::UnitZ()};
  return crossing.mount * Transform{rotation_about(Vec3::UnitZ(), value), Vec3::Zero()};
}

/// The box of the joint limits.
JointBox all_values_of(std::span<const MovingJoint> joints) {
  JointBox box;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const auto [lower, upper] = joints[i].limits;
    box.middle[i] = 0.5 * (lower + upper);
    box.half[i] = 0.5 * (upper - lower);
  }
  return box;
}

/// Displacement bound of the spheres, seen from beyond each crossing, in metres per unit of its
/// joint. The distance from the joint's axis is exact for the first crossing, a bound for others.
std::vector<double> speeds_along(std::span<const Crossing> path, std::span<const Sphere> spheres) {
  std::vector<double> speeds;
  double radius = 0;
  for (const Crossing& crossing : path) {
    double to_axis = 0;
    if (speeds.empty()) {
      for (const Sphere& sphere : spheres) {
        const Vec3 point =
            crossing.is_upward ? sphere.center : crossing.mount.inverse() * sphere.center;
        radius = std::max(radius, point.norm());
        to_axis = std::max(to_axis, std::hypot(point.x(), point.y()));
      }
    } else {
      if (!crossing.is_upward) radius += crossing.mount.translation.norm();
      to_axis = radius;
    }
    speeds.push_back(std::abs(crossing.multiplier) * (crossing.is_prismatic ? 1.0 : to_axis));
    radius += crossing.slide;
    if (crossing.is_upward) radius += crossing.mount.translation.norm();
  }
  return speeds;
}

/// Distance between the nearest two surfaces; `X_AB` is the pose of the second set's frame.
double gap(const Transform& X_AB, std::span<const Sphere> a, std::span<const Sphere> b) {
  double least = std::numeric_limits<double>::infinity();
  for (const Sphere& second : b) {
    const Vec3 center = X_AB * second.center;
    for (const Sphere& first : a) {
      least = std::min(least, (first.center - center).norm() - first.radius - second.radius);
    }
  }
  return least;
}

std::pair<double, double> limits_of(const Joint& joint) {
  if (joint.type == JointType::continuous) return {-std::numbers::pi, std::numbers::pi};
  return {joint.lower, joint.upper};
}

}  // namespace

Linkage::Linkage(const Robot& robot, const RobotTables& tables, int frame_a, int frame_b) {
  std::vector<Crossing> down;
  while (frame_a != frame_b) {
    const bool is_upward = frame_a > frame_b;
    int& lower = is_upward ? frame_a : frame_b;
    const FrameRow& row = tables.frames[as_index(lower - 1)];
    (is_upward ? there_ : down).push_back(crossing(robot, row, is_upward));
    lower = row.parent;
  }
  there_.insert(there_.end(), down.rbegin(), down.rend());
  back_.assign(there_.rbegin(), there_.rend());
  for (Crossing& crossing : back_) crossing.is_upward = !crossing.is_upward;
}

Linkage::Crossing Linkage::crossing(const Robot& robot, const FrameRow& row, bool is_upward) {
  using RowMajor = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;
  auto joint = std::ranges::find(joints_, row.joint, &MovingJoint::index);
  if (joint == joints_.end()) {
    joints_.push_back({row.joint, limits_of(robot.group_joint(row.joint))});
    joint = std::prev(joints_.end());
  }
  if (row.is_prismatic || std::abs(row.multiplier) != 1) joint->has_period = false;
  Crossing result{{Eigen::Map<const RowMajor>(row.rotation).cast<double>(),
                   Eigen::Map<const Eigen::Vector3f>(row.translation).cast<double>()},
                  row.is_prismatic,
                  row.multiplier,
                  row.offset,
                  static_cast<std::size_t>(joint - joints_.begin()),
                  0,
                  is_upward};
  if (!row.is_prismatic) return result;
  for (const double value : {joint->limits.first, joint->limits.second}) {
    result.slide = std::max(result.slide, std::abs(result.multiplier * value + result.offset));
  }
  return result;
}

Transform Linkage::pose_at(const JointValues& values) const {
  assert(joints_.size() <= values.size());
  Transform X_AB;
  for (const Crossing& crossing : there_) {
    const Transform pose = pose_of(crossing, values);
    X_AB = X_AB * (crossing.is_upward ? pose.inverse() : pose);
  }
  return X_AB;
}

JointValues Linkage::find_speeds(std::span<const Sphere> a, std::span<const Sphere> b) const {
  assert(joints_.size() <= kMostJointsBetween);
  // Either set may be considered at rest, so the slower motion is a bound.
  const std::vector<double> of_a = speeds_along(there_, a), of_b = speeds_along(back_, b);
  JointValues speeds = {};
  for (std::size_t i = 0; i < there_.size(); ++i) {
    speeds[there_[i].joint] += std::min(of_a[i], of_b[there_.size() - 1 - i]);
  }
  return speeds;
}

bool Linkage::can_meet(std::span<const Sphere> a, std::span<const Sphere> b) const {
  if (joints_.size() > kMostJointsBetween) return true;
  const JointValues speeds = find_speeds(a, b);
  std::vector<JointBox> boxes = {all_values_of(joints_)};
  for (int visited = 0; !boxes.empty(); ++visited) {
    if (visited == kMostBoxes) return true;
    JointBox box = boxes.back();
    boxes.pop_back();
    const double apart = gap(pose_at(box.middle), a, b) - kKernelRounding;
    if (apart < 0) return true;
    std::size_t widest = 0;
    double change = 0;
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      change += box.half[i] * speeds[i];
      if (box.half[i] * speeds[i] > box.half[widest] * speeds[widest]) widest = i;
    }
    if (change <= apart) continue;
    box.half[widest] /= 2;
    for (const double side : {-1.0, 1.0}) {
      boxes.push_back(box);
      boxes.back().middle[widest] += side * box.half[widest];
    }
  }
  return false;
}

}  // namespace mneme::internal
