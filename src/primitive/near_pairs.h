// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Which obstacles may form a pair at all, and as what.
#pragma once

#include "mneme/scene.h"

#include <optional>
#include <utility>
#include <vector>

namespace mneme::internal {

/// The scene with oriented boxes in place of points, meshes and octrees, which are no bodies that a
/// key could tell. Nothing if that is the scene itself, or leaves no pair.
[[nodiscard]] std::optional<Scene> with_boxed_compounds(const Scene& scene);

/// More pairs than this are no memory but a search of their own, and fill gigabytes.
inline constexpr std::size_t kMaxNearPairs = 500000;

/// Pairs of indices, the lesser first, in their order: all pairs of obstacles that are at most
/// `gap` metres apart, and some that are further apart. Sorts and sweeps, so that 10^5 obstacles
/// take no 10^10 looks. Errors: unsupported, if there are more than `most`.
[[nodiscard]] Result<std::vector<std::pair<int, int>>> find_near_pairs(
    const Scene& scene, double gap, std::size_t most = kMaxNearPairs);

}  // namespace mneme::internal
