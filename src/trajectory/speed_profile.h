// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// How fast a rounded path can be followed.
#pragma once

#include "mneme/trajectory.h"

#include "trajectory/rounded_path.h"

#include <vector>

namespace mneme::internal {

struct Followed {
  Trajectory motion;
  /// Of each curve, and of the end, before averages.
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

}  // namespace mneme::internal
