// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "collision/joint_reach.h"

#include "base/as_index.h"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace mneme::internal {
namespace {

constexpr std::size_t kMostJoints = 2;
constexpr int kMostBoxes = 1000;
/// Metres; covers what the kernels' single precision loses.
constexpr double kSafety = 1e-3;

/// Values of the joints between the spheres: a box in their space.
struct JointBox {
  std::array<double, kMostJoints> middle = {}, half = {};
};

/// Moves two spheres by the joints between them, in the frame that carries both.
class Linkage {
 public:
  Linkage(const Robot& robot, const RobotTables& tables, const CarriedSphere& a,
          const CarriedSphere& b)
      : robot_(robot), tables_(tables), a_(a.sphere.center), b_(b.sphere.center) {
    int from_a = a.frame, from_b = b.frame;
    while (from_a != from_b) {
      int& lower = from_a > from_b ? from_a : from_b;
      (from_a > from_b ? rows_to_a_ : rows_to_b_).push_back(lower - 1);
      lower = row(lower - 1).parent;
    }
    measure(rows_to_a_, a_);
    measure(rows_to_b_, b_);
  }

  /// Group joints that move one sphere against the other.
  [[nodiscard]] std::size_t joint_count() const { return joints_.size(); }

  [[nodiscard]] JointBox limits() const {
    JointBox box;
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      const auto [lower, upper] = limits_of(joints_[i]);
      box.middle[i] = 0.5 * (lower + upper);
      box.half[i] = 0.5 * (upper - lower);
    }
    return box;
  }

  /// Between the centres, with the joints at the middle of the box.
  [[nodiscard]] double distance(const JointBox& box) const {
    return (posed(rows_to_a_, a_, box) - posed(rows_to_b_, b_, box)).norm();
  }

  /// How much the distance can change within the box by joint `i`.
  [[nodiscard]] double change(const JointBox& box, std::size_t i) const {
    return box.half[i] * speed_[i];
  }

 private:
  [[nodiscard]] const FrameRow& row(int index) const { return tables_.frames[as_index(index)]; }

  [[nodiscard]] std::pair<double, double> limits_of(int joint) const {
    const Joint& group_joint = robot_.group_joint(joint);
    if (group_joint.type == JointType::continuous) return {-std::numbers::pi, std::numbers::pi};
    return {group_joint.lower, group_joint.upper};
  }

  static double value_of(const FrameRow& frame, double joint_value) {
    return frame.multiplier * joint_value + frame.offset;
  }

  std::size_t position_of(int joint) {
    const auto found = std::find(joints_.begin(), joints_.end(), joint);
    if (found != joints_.end()) return static_cast<std::size_t>(found - joints_.begin());
    joints_.push_back(joint);
    speed_.push_back(0);
    return joints_.size() - 1;
  }

  /// Adds what a joint's motion can do to a point at the end of the chain, from there inwards.
  void measure(const std::vector<int>& rows, const Vec3& point) {
    double radius = point.norm();
    for (const int index : rows) {
      const FrameRow& frame = row(index);
      speed_[position_of(frame.joint)] +=
          std::abs(static_cast<double>(frame.multiplier)) * (frame.is_prismatic ? 1.0 : radius);
      radius += Eigen::Map<const Eigen::Vector3f>(frame.translation).cast<double>().norm();
      if (!frame.is_prismatic) continue;
      const auto [lower, upper] = limits_of(frame.joint);
      radius += std::max(std::abs(value_of(frame, lower)), std::abs(value_of(frame, upper)));
    }
  }

  [[nodiscard]] Vec3 posed(const std::vector<int>& rows, Vec3 point, const JointBox& box) const {
    using RowMajor = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;
    for (const int index : rows) {
      const FrameRow& frame = row(index);
      const auto joint = std::find(joints_.begin(), joints_.end(), frame.joint) - joints_.begin();
      const double value = value_of(frame, box.middle[as_index(joint)]);
      point = frame.is_prismatic ? Vec3(point + value * Vec3::UnitZ())
                                 : Vec3(rotation_about(Vec3::UnitZ(), value) * point);
      point = Eigen::Map<const RowMajor>(frame.rotation).cast<double>() * point +
              Eigen::Map<const Eigen::Vector3f>(frame.translation).cast<double>();
    }
    return point;
  }

  const Robot& robot_;
  const RobotTables& tables_;
  Vec3 a_, b_;
  std::vector<int> rows_to_a_, rows_to_b_;  ///< from the sphere inwards
  std::vector<int> joints_;
  std::vector<double> speed_;  ///< metres per unit of each joint, at most
};

}  // namespace

bool can_meet(const Robot& robot, const RobotTables& tables, const CarriedSphere& a,
              const CarriedSphere& b) {
  const Linkage linkage(robot, tables, a, b);
  if (linkage.joint_count() > kMostJoints) return true;
  const double reach = a.sphere.radius + b.sphere.radius + kSafety;
  std::vector<JointBox> boxes = {linkage.limits()};
  for (int looked_at = 0; !boxes.empty(); ++looked_at) {
    if (looked_at == kMostBoxes) return true;
    JointBox box = boxes.back();
    boxes.pop_back();
    const double gap = linkage.distance(box) - reach;
    if (gap < 0) return true;
    std::size_t widest = 0;
    double change = 0;
    for (std::size_t i = 0; i < linkage.joint_count(); ++i) {
      change += linkage.change(box, i);
      if (linkage.change(box, i) > linkage.change(box, widest)) widest = i;
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
