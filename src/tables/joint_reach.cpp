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
constexpr int kMostBoxes = 1000;
/// Metres; covers what the kernels' single precision loses.
constexpr double kSafety = 1e-3;

/// Values of the joints between the spheres: a box in their space.
struct JointBox {
  std::array<double, kMostJoints> middle = {}, half = {};
};

/// A frame row that lies between the spheres.
struct Crossing {
  Transform mount;  ///< of the joint in the parent's frame
  bool is_prismatic = false;
  double multiplier = 1, offset = 0;
  std::size_t joint = 0;   ///< of those between the spheres
  double slide = 0;        ///< metres that a prismatic joint moves at most
  bool is_upward = false;  ///< from child to parent on the way from one set to the other

  [[nodiscard]] Transform pose(const JointBox& box) const {
    const double value = multiplier * box.middle[joint] + offset;
    if (is_prismatic) return mount * Transform{Eigen::Matrix3d::Identity(), value * Vec3::UnitZ()};
    return mount * Transform{rotation_about(Vec3::UnitZ(), value), Vec3::Zero()};
  }
};

/// Metres per unit of each crossing's joint that spheres move at most against what lies beyond it:
/// by their distance from its axis, which is exact for the first and bounded for the others.
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

/// Moves two sets of spheres by the joints between them.
class Linkage {
 public:
  Linkage(const Robot& robot, const RobotTables& tables, const CarriedSpheres& a,
          const CarriedSpheres& b)
      : a_(a.spheres), b_(b.spheres) {
    std::vector<Crossing> down;
    int from_a = a.frame, from_b = b.frame;
    while (from_a != from_b) {
      const bool is_upward = from_a > from_b;
      int& lower = is_upward ? from_a : from_b;
      const FrameRow& row = tables.frames[as_index(lower - 1)];
      (is_upward ? path_ : down).push_back(crossing(robot, row, is_upward));
      lower = row.parent;
    }
    path_.insert(path_.end(), down.rbegin(), down.rend());
    add_speeds();
  }

  /// Group joints that move one set against the other.
  [[nodiscard]] std::size_t joint_count() const { return joints_.size(); }

  /// All values that the joints may have.
  [[nodiscard]] JointBox limits() const {
    JointBox box;
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      const auto [lower, upper] = joints_[i].limits;
      box.middle[i] = 0.5 * (lower + upper);
      box.half[i] = 0.5 * (upper - lower);
    }
    return box;
  }

  /// Between the surfaces of the nearest two, with the joints at the middle of the box.
  [[nodiscard]] double gap(const JointBox& box) const {
    Transform X_AB;
    for (const Crossing& crossing : path_) {
      const Transform pose = crossing.pose(box);
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

  /// How much the gap can change within the box by joint `i`.
  [[nodiscard]] double change(const JointBox& box, std::size_t i) const {
    return box.half[i] * joints_[i].speed;
  }

 private:
  struct MovingJoint {
    int index = 0;  ///< in the group
    std::pair<double, double> limits;
    double speed = 0;  ///< metres per unit, at most
  };

  static std::pair<double, double> limits_of(const Joint& joint) {
    if (joint.type == JointType::continuous) return {-std::numbers::pi, std::numbers::pi};
    return {joint.lower, joint.upper};
  }

  Crossing crossing(const Robot& robot, const FrameRow& row, bool is_upward) {
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

  /// Either set may be thought at rest, so that the slower motion bounds both.
  void add_speeds() {
    const std::vector<double> of_a = find_speeds(path_, a_);
    std::vector<Crossing> back(path_.rbegin(), path_.rend());
    for (Crossing& crossing : back) crossing.is_upward = !crossing.is_upward;
    const std::vector<double> of_b = find_speeds(back, b_);
    for (std::size_t i = 0; i < path_.size(); ++i) {
      joints_[path_[i].joint].speed += std::min(of_a[i], of_b[path_.size() - 1 - i]);
    }
  }

  std::span<const Sphere> a_, b_;
  std::vector<Crossing> path_;  ///< from the first set to the second
  std::vector<MovingJoint> joints_;
};

}  // namespace

bool can_meet(const Robot& robot, const RobotTables& tables, const CarriedSpheres& a,
              const CarriedSpheres& b) {
  const Linkage linkage(robot, tables, a, b);
  if (linkage.joint_count() > kMostJoints) return true;
  std::vector<JointBox> boxes = {linkage.limits()};
  for (int looked_at = 0; !boxes.empty(); ++looked_at) {
    if (looked_at == kMostBoxes) return true;
    JointBox box = boxes.back();
    boxes.pop_back();
    const double gap = linkage.gap(box) - kSafety;
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
