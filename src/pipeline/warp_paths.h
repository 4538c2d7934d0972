// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Whole remembered paths as components for another query.
#pragma once

#include <span>

#include "mneme/pipeline.h"

namespace mneme::internal {

/// The waypoints between the ends of remembered paths, each twice: warped, so that the path's ends
/// become those of the query, and as it was. The warp of a waypoint adds the differences of the
/// ends, each in proportion to how near the waypoint is to that end along the path. Origins count
/// the matches. A path that was remembered the other way round is turned round.
[[nodiscard]] GaussianMixture warp_paths(const Robot& robot, std::span<const double> start,
                                         std::span<const double> goal,
                                         std::span<const Match> matches);

}  // namespace mneme::internal
