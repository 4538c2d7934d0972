// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tables/joint_reach.h"

#include "base/as_index.h"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <vector>

namespace mneme::internal {
namespace {

constexpr std::size_t kMostJoints = 2;
constexpr int kMostBoxes = 256;
/// Metres; larger than the rounding errors of the kernels.
constexpr double kSafety = 1e-3;

using Crossing = Linkage::Crossing;
using MovingJoint = Linkage::MovingJoint;

/// A box in the space of the joints between the spheres.
struct JointBox {
  std::array<double, kMostJoints> middle = {}, half = {};
};

/// Pose of the child's frame in its parent, with the joints at the middle of the box.
Transform pose_of(const Crossing& crossing, const JointBox& box) {
  const double value = crossing.multiplier * box.middle[crossing.joint] + crossing.offset;
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
std::vector<double> find_speeds(std::span<const Crossing> path, std::span<const Sphere> spheres) {
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

/// Two sets of spheres on the two frames.
class MovingSpheres {
 public:
  MovingSpheres(std::span<const Sphere> a, std::span<const Sphere> b,
                std::span<const Crossing> there, std::span<const Crossing> back)
      : a_(a), b_(b), there_(there) {
    // Either set may be considered at rest, so the slower motion is a bound.
    const std::vector<double> of_a = find_speeds(there, a), of_b = find_speeds(back, b);
    for (std::size_t i = 0; i < there.size(); ++i) {
      speeds_[there[i].joint] += std::min(of_a[i], of_b[there.size() - 1 - i]);
    }
  }

  /// Distance between the nearest two surfaces, with the joints at the middle of the box.
  [[nodiscard]] double gap(const JointBox& box) const {
    Transform X_AB;
    for (const Crossing& crossing : there_) {
      const Transform pose = pose_of(crossing, box);
      X_AB = X_AB * (crossing.is_upward ? pose.inverse() : pose);
    }
    double least = std::numeric_limits<double>::infinity();
    for (const Sphere& b : b_) {
      const Vec3 center = X_AB * b.center;
      for (const Sphere& a : a_) {
        least = std::min(least, (a.center - center).norm() - a.radius - b.radius);
      }
    }
    return least;
  }

  /// Bound on the change of the gap within the box by joint `i`.
  [[nodiscard]] double change(const JointBox& box, std::size_t i) const {
    return box.half[i] * speeds_[i];
  }

 private:
  std::span<const Sphere> a_, b_;
  std::span<const Crossing> there_;
  std::array<double, kMostJoints> speeds_ = {};  ///< bounds, metres per unit of each joint
};

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

bool Linkage::can_meet(std::span<const Sphere> a, std::span<const Sphere> b) const {
  if (joints_.size() > kMostJoints) return true;
  const MovingSpheres spheres(a, b, there_, back_);
  std::vector<JointBox> boxes = {all_values_of(joints_)};
  for (int visited = 0; !boxes.empty(); ++visited) {
    if (visited == kMostBoxes) return true;
    JointBox box = boxes.back();
    boxes.pop_back();
    const double gap = spheres.gap(box) - kSafety;
    if (gap < 0) return true;
    std::size_t widest = 0;
    double change = 0;
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      change += spheres.change(box, i);
      if (spheres.change(box, i) > spheres.change(box, widest)) widest = i;
    }
    if (change <= gap) continue;
    box.half[widest] /= 2;
    for (const double side : {-1.0, 1.0}) {
      boxes.push_back(box);
      boxes.back().middle[widest] += side * box.half[widest];
    }
  }
  return false;
}

}  // namespace mneme::internal
