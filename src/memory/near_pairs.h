// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Finds pairs of obstacles that are close to each other.
#pragma once

#include "mneme/scene.h"

#include <optional>
#include <utility>
#include <vector>

namespace mneme::internal {

/// The scene with oriented boxes instead of clouds, meshes and octrees, whose moments are not
/// computed. Nothing if the scene has no such shape or less than two obstacles.
[[nodiscard]] std::optional<Scene> with_boxed_compounds(const Scene& scene);

/// Limit on pairs; more would fill gigabytes.
inline constexpr std::size_t kMaxNearPairs = 500000;

/// Sorted pairs of indices, the smaller first: all pairs of obstacles at most `gap` metres apart,
/// and some further apart. Sort and sweep: O(n log n + pairs) for boxes spread along one axis.
/// Error: unsupported for more than `most` pairs.
[[nodiscard]] Result<std::vector<std::pair<int, int>>> find_near_pairs(
    const Scene& scene, double gap, std::size_t most = kMaxNearPairs);

/// Least distance between shapes of two obstacles, metres; infinite if beyond `most`.
[[nodiscard]] double obstacle_distance(const Obstacle& a, const Obstacle& b, double most);

}  // namespace mneme::internal
