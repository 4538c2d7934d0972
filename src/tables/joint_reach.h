// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Spheres that joint limits keep apart in every configuration.
#pragma once

#include "mneme/geometry.h"
#include "mneme/robot.h"

#include "tables/tables.h"

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace mneme::internal {

/// The joints between two frames: 0 is the robot's root, i + 1 is frame row i.
class Linkage {
 public:
  /// `tables` needs its frames only.
  Linkage(const Robot& robot, const RobotTables& tables, int frame_a, int frame_b);

  /// False if no configuration within the limits brings one of `a`, which the first frame carries,
  /// closer than a millimetre to one of `b`, which the second one does; true if one does, or if
  /// that could not be ruled out with bounded effort: at most two joints are considered.
  [[nodiscard]] bool can_meet(std::span<const Sphere> a, std::span<const Sphere> b) const;

  /// A frame row on the way from one frame to the other.
  struct Crossing {
    Transform mount;  ///< of the joint in the parent's frame
    bool is_prismatic = false;
    double multiplier = 1, offset = 0;
    std::size_t joint = 0;   ///< of those between the frames
    double slide = 0;        ///< metres that a prismatic joint moves at most
    bool is_upward = false;  ///< from child to parent
  };
  /// A joint of the robot's group between the frames.
  struct MovingJoint {
    int index = 0;  ///< in the group
    std::pair<double, double> limits;
  };

 private:
  Crossing crossing(const Robot& robot, const FrameRow& row, bool is_upward);

  std::vector<Crossing> there_, back_;
  std::vector<MovingJoint> joints_;
};

}  // namespace mneme::internal
