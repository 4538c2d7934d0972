// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Motions whose jerk is limited.
#pragma once

#include "mneme/trajectory.h"

#include "trajectory/rounded_path.h"

namespace mneme::internal {

[[nodiscard]] bool has_jerk_limit(const RateLimits& limits);

/// A motion along the path, averaged over a window of time that is long enough for the limits of
/// jerk, of which there is one. On straight curves that changes nothing but the times. Near
/// parabolas it leads off the path, by at most `tolerance`, and is verified again: where it does
/// not pass, the path's corner is stopped at. Accelerations are lowered where a shorter window
/// makes up for that.
[[nodiscard]] Trajectory follow_smoothly(RoundedPath path, const RateLimits& limits,
                                         double tolerance, const MotionVerifier* verifier);

}  // namespace mneme::internal
