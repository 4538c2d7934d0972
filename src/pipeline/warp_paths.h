// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Whole remembered paths as components for another query.
#pragma once

#include <span>

#include "mneme/pipeline.h"

namespace mneme::internal {

/// The waypoints between the ends of remembered paths, each twice: warped, so that the path's ends
/// become those of the query, and as it was. The warp of a waypoint adds the differences of the
/// ends, each in proportion to how near the waypoint is to that end along the path. A path that was
/// remembered the other way round is turned round. `retrievals` has one entry per goal, in their
/// order, which origins count.
[[nodiscard]] GaussianMixture warp_paths(const Robot& robot, const Configuration& start,
                                         std::span<const Configuration> goals,
                                         std::span<const PrimitiveRetrieval> retrievals);

}  // namespace mneme::internal
