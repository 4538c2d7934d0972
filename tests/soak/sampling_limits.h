// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// How deep contact between two checked states of a motion can be.
#pragma once

#include "mneme/robot.h"

namespace mneme::soak {

struct SamplingLimits {
  double speed = 0;     ///< metres that a point of the robot moves per radian of joint distance
  double thinnest = 0;  ///< metres: the least radius of a shape that moves
};

/// The speed is the largest Frobenius norm of a point's Jacobian over `samples` random
/// configurations and the far sides of all shapes: no direction of motion is faster there.
[[nodiscard]] SamplingLimits measure_limits(const Robot& robot, int samples, Rng& rng);

/// Metres by which a shape of radius `radius` can cut into an edge, or a ball of radius `radius`
/// into a point, between two states that are `step` metres apart: the height of the arc over the
/// chord; all of the diameter if the step is longer than that.
[[nodiscard]] double deepest_cut(double radius, double step);

}  // namespace mneme::soak
