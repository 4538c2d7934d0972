// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Motions that take less time by leaving their path.
#pragma once

#include "mneme/trajectory.h"

#include "trajectory/rounded_path.h"

namespace mneme::internal {

/// Returns a faster motion near `motion`, which follows `legs`, or `motion` itself. It is at most
/// the path tolerance away from the legs and passes `verifier`. Deterministic.
[[nodiscard]] Trajectory shorten_time(const Robot& robot, Trajectory motion, const Legs& legs,
                                      const RateLimits& limits, const TrajectorySettings& settings,
                                      const MotionVerifier& verifier);

}  // namespace mneme::internal
