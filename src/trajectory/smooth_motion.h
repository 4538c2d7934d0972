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
                                       const Configuration& end,
                                       std::vector<double> end_velocity = {});

/// How a motion passes along legs.
struct FollowSettings {
  double tolerance = 0;      ///< largest distance from the legs at corners, L2 joint distance
  bool stops_first = false;  ///< at the first corner
  double begin_speed = 0;    ///< along the first leg; reach_to_stop() is at most the leg's length
  double end_speed = 0;      ///< along the last leg, likewise
  bool is_estimate = false;  ///< takes all corners as free if there is no verifier
  bool is_guide = false;     ///< checks states of corners only, which proves nothing
  double guide_margin = 0;   ///< that these states keep from contact, metres
};

/// Returns a motion along `legs` within `limits`. It is time-optimal along each
/// leg. At a corner, velocities change at once for all joints, with trapezoidal accelerations: the
/// corner is cut as fast as `verifier` passes. At corners that do not pass, or at all if `verifier`
/// is null, the motion stops.
[[nodiscard]] std::vector<JerkPiece> follow_legs(const Legs& legs, const RateLimits& limits,
                                                 const FollowSettings& settings,
                                                 const MotionVerifier* verifier);

/// Returns the duration of that motion.
[[nodiscard]] double duration_along(const Legs& legs, const RateLimits& limits,
                                    const FollowSettings& settings, const MotionVerifier* verifier);

/// Returns the length that a stop from `speed` takes in `direction`, a unit vector.
[[nodiscard]] double reach_to_stop(const std::vector<double>& direction, double speed,
                                   const RateLimits& limits);

}  // namespace mneme::internal
