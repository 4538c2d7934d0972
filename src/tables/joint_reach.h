// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Proves that joint limits keep spheres apart in every configuration.
#pragma once

#include "mneme/geometry.h"
#include "mneme/robot.h"

#include "tables/tables.h"

#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace mneme::internal {

/// Metres; larger than the rounding errors of the kernels.
inline constexpr double kKernelRounding = 1e-3;

/// A value for each of up to kMostJointsBetween joints.
using JointValues = std::array<double, kMostJointsBetween>;
/// A box in the space of the joints between two frames.
struct JointBox {
  JointValues middle = {}, half = {};
};

/// The joints between two frames. Frame 0 is the robot's root, i + 1 is frame row i.
class Linkage {
 public:
  /// `tables` needs its frames only.
  Linkage(const Robot& robot, const RobotTables& tables, int frame_a, int frame_b);

  /// False if it is proven that no configuration within the limits brings a sphere of `a`, on the
  /// first frame, within a millimetre of a sphere of `b`, on the second. The effort is bounded.
  /// Always true with more than two joints between the frames.
  [[nodiscard]] bool can_meet(std::span<const Sphere> a, std::span<const Sphere> b) const;

  /// A frame row on the path from one frame to the other.
  struct Crossing {
    Transform mount;  ///< pose of the joint in the parent's frame
    bool is_prismatic = false;
    double multiplier = 1, offset = 0;
    std::size_t joint = 0;   ///< index into the joints between the frames
    double slide = 0;        ///< largest offset of a prismatic joint, metres
    bool is_upward = false;  ///< from child to parent
  };
  /// A joint of the robot's group between the frames.
  struct MovingJoint {
    int index = 0;  ///< into the group
    std::pair<double, double> limits;
    bool has_period = true;  ///< poses repeat after a full turn
  };

  [[nodiscard]] std::span<const MovingJoint> joints() const { return joints_; }
  /// Returns the pose of the second frame in the first. There are at most kMostJointsBetween
  /// joints.
  [[nodiscard]] Transform pose_at(const JointValues& values) const;
  /// Returns displacement bounds of spheres of `a` and `b` against each other within the limits,
  /// metres per unit of each joint.
  [[nodiscard]] JointValues find_speeds(std::span<const Sphere> a, std::span<const Sphere> b) const;

 private:
  Crossing crossing(const Robot& robot, const FrameRow& row, bool is_upward);

  std::vector<Crossing> there_, back_;
  std::vector<MovingJoint> joints_;
};

}  // namespace mneme::internal
