// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// How fast a rounded path can be followed: within limits of rates, and of jerk.
#pragma once

#include "mneme/trajectory.h"

#include "trajectory/rounded_path.h"

#include <vector>

namespace mneme::internal {

/// Error: invalid, naming the joint, unless there are limits within range for each of the group.
[[nodiscard]] Result<void> check_rate_limits(const Robot& robot, const RateLimits& limits);

struct Followed {
  Trajectory motion;
  /// Times at which each curve begins, and the end, before averages.
  std::vector<double> begins_s;
};

/// The fastest motion along the path from rest to rest, by reachability analysis (Pham and Pham,
/// DOI 10.1109/TRO.2018.2819195) in the square of the path speed, averaged over `window_s`; with a
/// window it stays for as long where it stops, so that averages of before and behind do not meet.
/// Straight curves are exact; parabolas have cells of constant path acceleration. On a parabola,
/// acceleration of a joint is linear in a cell, because slope and squared path speed are: limits
/// that hold at both ends hold in between.
[[nodiscard]] Followed follow_fastest(const RoundedPath& path, const RateLimits& limits,
                                      double window_s = 0);

[[nodiscard]] bool has_jerk_limit(const RateLimits& limits);

/// A motion along the path, averaged over a window of time that is long enough for the limits of
/// jerk, of which there is one. On straight curves that changes nothing but the times. Near
/// parabolas it leads off the path, by at most `tolerance`, and is verified again: where it does
/// not pass, the path's corner is stopped at. Accelerations are lowered where a shorter window
/// makes up for that.
[[nodiscard]] Trajectory follow_smoothly(RoundedPath path, const RateLimits& limits,
                                         double tolerance, const MotionVerifier* verifier);

}  // namespace mneme::internal
