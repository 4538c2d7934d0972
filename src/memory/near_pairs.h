// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Pairs of obstacles that are close to each other.
#pragma once

#include "mneme/scene.h"

#include <optional>
#include <utility>
#include <vector>

namespace mneme::internal {

/// The scene with oriented boxes in place of points, meshes and octrees, whose moments no key can
/// hold. Nothing if the scene has none of these, or no pair.
[[nodiscard]] std::optional<Scene> with_boxed_compounds(const Scene& scene);

/// More pairs than this fill gigabytes.
inline constexpr std::size_t kMaxNearPairs = 500000;

/// Pairs of indices, the lesser first, sorted: all pairs of obstacles that are at most `gap` metres
/// apart, and some that are further apart. Sorts and sweeps: O(n log n + pairs) where few boxes
/// share a place on the longest axis. Error: unsupported, if there are more than `most`.
[[nodiscard]] Result<std::vector<std::pair<int, int>>> find_near_pairs(
    const Scene& scene, double gap, std::size_t most = kMaxNearPairs);

/// Least distance between shapes of two obstacles, metres; infinite if all are further apart than
/// `most`.
[[nodiscard]] double obstacle_distance(const Obstacle& a, const Obstacle& b, double most);

}  // namespace mneme::internal
