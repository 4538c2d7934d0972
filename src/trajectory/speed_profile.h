// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// How fast a rounded path can be followed.
#pragma once

#include "mneme/trajectory.h"

#include "trajectory/rounded_path.h"

#include <vector>

namespace mneme::internal {

/// The fastest motion along the path from rest to rest, by reachability analysis (Pham and Pham,
/// DOI 10.1109/TRO.2018.2819195) in the square of the path speed. Straight curves are exact;
/// parabolas have `count` cells of constant path acceleration. On a parabola, acceleration of a
/// joint is linear in a cell, because slope and squared path speed are: limits that hold at both
/// ends hold in between.
[[nodiscard]] Trajectory follow_fastest(const RoundedPath& path, const RateLimits& limits,
                                        int count = 16);

}  // namespace mneme::internal
