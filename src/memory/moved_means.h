// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What kinds of memory share whose primitives are pairs of obstacles: means that a symmetry of the
/// robot moves to the query, and waypoints of solved paths that belong to a primitive.
#pragma once

#include "mneme/memory.h"

namespace mneme::internal {

/// Algorithm 2, line 10: pools the components of all matches, each moved to the scene by its
/// symmetry, equally likely; that is what a_i = M_i / N says. Components count for the primitive
/// that they were retrieved for, and stand in order of relevance: the most similar match first.
/// Those that a symmetry moves outside the joint limits are dropped.
[[nodiscard]] GaussianMixture pool_moved_means(const MemoryQuery& query,
                                               std::span<const PrimitiveRetrieval> primitives);

/// MemoryKind::retarget of the kind "pairs". A match is a group. Pairs that start or a goal cross
/// come first: the best match of each of them takes part from the first draw on; then those of the
/// others, then the second best ones, and so on. Means that are deeper in a gap than start and
/// goals are have nothing to say, nor have those that GapFit or the joint limits refuse. Null for
/// an arm that is no PlanarChain.
[[nodiscard]] std::shared_ptr<const ComponentSource> retarget_means(
    const MemoryQuery& query, std::span<const PrimitiveRetrieval> primitives,
    SampleSource first_source);

/// Per primitive one row with the waypoints of `paths` that belong to it, moved to the canonical
/// frame; see learn_from_paths(). Primitives without a waypoint have none.
[[nodiscard]] std::vector<Experience> gather_waypoints(
    const MemoryQuery& query, const std::vector<LocalPrimitive>& primitives,
    std::span<const Path> paths, double reach);

/// MemoryKind::learn_from_paths of a kind that decomposes so.
template <Result<std::vector<LocalPrimitive>> (*decompose)(const MemoryQuery&, double)>
[[nodiscard]] Result<std::vector<Experience>> learn_waypoints(const MemoryQuery& query,
                                                              std::span<const Path> paths,
                                                              double max_gap, double reach) {
  return decompose(query, max_gap).map([&](const std::vector<LocalPrimitive>& primitives) {
    return gather_waypoints(query, primitives, paths, reach);
  });
}

}  // namespace mneme::internal
