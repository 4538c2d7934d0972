// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What joint limits keep apart in every configuration.
#pragma once

#include "mneme/geometry.h"
#include "mneme/robot.h"

#include "collision/tables.h"

namespace mneme::internal {

/// A sphere in the coordinates of a frame: 0 is the robot's root, i + 1 is frame row i.
struct CarriedSphere {
  int frame = 0;
  Sphere sphere;
};

/// False if no configuration within the limits brings the spheres closer than a millimetre; true if
/// one does, or if that could not be ruled out with bounded effort: at most two joints between the
/// frames are looked at. `tables` needs its frames only.
[[nodiscard]] bool can_meet(const Robot& robot, const RobotTables& tables, const CarriedSphere& a,
                            const CarriedSphere& b);

}  // namespace mneme::internal
