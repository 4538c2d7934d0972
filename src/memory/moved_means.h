// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Shared by kinds whose primitives are pairs of obstacles: moves stored means to a query by
/// symmetries of the robot, and assigns waypoints of solved paths to primitives.
#pragma once

#include "mneme/memory.h"

namespace mneme::internal {

/// Algorithm 2, line 10: pools the components of all matches, moved to the scene by their
/// symmetries, with equal weights (a_i = M_i / N). A component's source is its primitive. The most
/// similar match comes first. Components moved outside the joint limits are dropped.
[[nodiscard]] GaussianMixture pool_moved_means(const MemoryQuery& query,
                                               std::span<const PrimitiveRetrieval> primitives);

/// MemoryKind::retarget of the kind "pairs". Each match is a group of components. Order: best
/// matches of pairs that the start or a goal crosses, which are sampled from the beginning;
/// second-best ones of these pairs, and so on; then the matches of other pairs. Skips means deeper
/// in a gap than start and goals, and means that GapFit or the joint limits reject. Null for an arm
/// that is no PlanarChain.
[[nodiscard]] std::shared_ptr<const ComponentSource> retarget_means(
    const MemoryQuery& query, std::span<const PrimitiveRetrieval> primitives,
    SampleSource first_source);

/// One row per primitive with the waypoints of `paths` that belong to it, in the canonical frame;
/// see learn_from_paths(). Primitives without a waypoint are skipped.
[[nodiscard]] std::vector<Experience> gather_waypoints(
    const MemoryQuery& query, const std::vector<LocalPrimitive>& primitives,
    std::span<const Path> paths, double reach);

/// MemoryKind::learn_from_paths for a kind with this `decompose`.
template <Result<std::vector<LocalPrimitive>> (*decompose)(const MemoryQuery&, double)>
[[nodiscard]] Result<std::vector<Experience>> learn_waypoints(const MemoryQuery& query,
                                                              std::span<const Path> paths,
                                                              double max_gap, double reach) {
  return decompose(query, max_gap).map([&](const std::vector<LocalPrimitive>& primitives) {
    return gather_waypoints(query, primitives, paths, reach);
  });
}

}  // namespace mneme::internal
