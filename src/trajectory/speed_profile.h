// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Time-optimal motion along a rounded path within rate limits.
#pragma once

#include "mneme/trajectory.h"

#include "trajectory/rounded_path.h"

#include <limits>

namespace mneme::internal {

inline constexpr double kRoom = 1 - 1e-9;  ///< share of the limits that is used, for rounding
inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();

/// Errors: invalid, naming the joint, if a limit is missing or out of range.
[[nodiscard]] Result<void> check_rate_limits(const Robot& robot, const RateLimits& limits);

/// Returns the fastest motion along the path from rest to rest. Reachability analysis in the
/// squared path speed: Pham and Pham, DOI 10.1109/TRO.2018.2819195. Straight curves are exact.
/// Parabolas have cells of constant path acceleration, in which a joint's acceleration is linear:
/// limits that hold at both ends hold in between.
[[nodiscard]] Trajectory follow_fastest(const RoundedPath& path, const RateLimits& limits);

}  // namespace mneme::internal
