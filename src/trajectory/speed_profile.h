// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Time-optimal motion along a rounded path within rate limits.
#pragma once

#include "mneme/trajectory.h"

#include "trajectory/rounded_path.h"

#include <vector>

namespace mneme::internal {

/// Errors: invalid, naming the joint, if a limit is missing or out of range.
[[nodiscard]] Result<void> check_rate_limits(const Robot& robot, const RateLimits& limits);

struct Followed {
  Trajectory motion;
  /// Time at which each curve begins, and the end, before averaging.
  std::vector<double> begins_s;
};

/// Returns the fastest motion along the path from rest to rest, averaged over `window_s`. With a
/// window it pauses for `window_s` at each stop, so that averages before and after do not overlap.
/// Reachability analysis in the squared path speed: Pham and Pham, DOI 10.1109/TRO.2018.2819195.
/// Straight curves are exact. Parabolas have cells of constant path acceleration, in which a
/// joint's acceleration is linear: limits that hold at both ends hold in between.
[[nodiscard]] Followed follow_fastest(const RoundedPath& path, const RateLimits& limits,
                                      double window_s = 0);

[[nodiscard]] bool has_jerk_limit(const RateLimits& limits);

/// Returns a motion along the path averaged over a window that is long enough for the jerk limits,
/// of which there must be one. On straight curves only times change. Near parabolas it leaves the
/// path by at most `tolerance` and is verified again; if it fails, it stops at the corner. Lower
/// accelerations are used where a shorter window makes the motion faster.
[[nodiscard]] Trajectory follow_smoothly(RoundedPath path, const RateLimits& limits,
                                         double tolerance, const MotionVerifier* verifier);

}  // namespace mneme::internal
