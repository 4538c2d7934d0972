// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What joint limits keep apart in every configuration.
#pragma once

#include "mneme/geometry.h"
#include "mneme/robot.h"

#include "tables/tables.h"

#include <span>

namespace mneme::internal {

/// Spheres in the coordinates of a frame: 0 is the robot's root, i + 1 is frame row i.
struct CarriedSpheres {
  int frame = 0;
  std::span<const Sphere> spheres;
};

/// False if no configuration within the limits brings one of `a` closer than a millimetre to one of
/// `b`; true if one does, or if that could not be ruled out with bounded effort: at most two joints
/// between the frames are looked at. `tables` needs its frames only.
[[nodiscard]] bool can_meet(const Robot& robot, const RobotTables& tables, const CarriedSpheres& a,
                            const CarriedSpheres& b);

}  // namespace mneme::internal
