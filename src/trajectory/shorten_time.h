// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Motions that take less time by leaving their path.
#pragma once

#include "mneme/trajectory.h"

#include "trajectory/rounded_path.h"

#include <optional>

namespace mneme::internal {

/// Returns a motion that takes less time than `motion`, which follows `legs`, is at most the path
/// tolerance away from the legs and passes `verifier`; nothing if none is found. `motion` need not
/// pass. Deterministic.
[[nodiscard]] std::optional<Trajectory> shorten_time(const Robot& robot, const Trajectory& motion,
                                                     const Legs& legs, const RateLimits& limits,
                                                     const TrajectorySettings& settings,
                                                     const MotionVerifier& verifier);

}  // namespace mneme::internal
