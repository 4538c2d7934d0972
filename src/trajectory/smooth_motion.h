// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Motions of limited jerk along straight legs, with rounded corners.
#pragma once

#include "mneme/trajectory.h"

#include "trajectory/rounded_path.h"

#include <vector>

namespace mneme::internal {

[[nodiscard]] bool has_jerk_limit(const RateLimits& limits);

/// Constant jerk of every joint.
struct JerkPiece {
  double duration_s = 0;
  std::vector<double> position, velocity, acceleration, jerk;  ///< at the begin
};
[[nodiscard]] Trajectory to_trajectory(const std::vector<JerkPiece>& pieces,
                                       const Configuration& end);

/// Returns a motion from rest to rest along `legs` within `limits`. It is time-optimal along each
/// leg. At a corner, velocities change at once for all joints, with trapezoidal accelerations: the
/// corner is cut by at most `tolerance` (L2 joint distance), as fast as `verifier` passes. At
/// corners that do not pass, or at all if `verifier` is null, the motion stops. `stops_first`: it
/// stops at the first corner.
[[nodiscard]] std::vector<JerkPiece> follow_legs(const Legs& legs, const RateLimits& limits,
                                                 double tolerance, bool stops_first,
                                                 const MotionVerifier* verifier);

}  // namespace mneme::internal
