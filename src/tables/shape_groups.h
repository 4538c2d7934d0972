// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Bounding balls, and groups of neighbouring shapes. A sphere is a capsule of length 0.
#pragma once

#include "mneme/geometry.h"

#include <span>
#include <vector>

namespace mneme::internal {

/// Returns a ball around capsules, at most a few percent larger than the smallest.
[[nodiscard]] Sphere enclosing_ball(std::span<const Capsule> shapes);

/// Returns the smallest ball around two balls.
[[nodiscard]] Sphere enclosing_ball(const Sphere& a, const Sphere& b);

/// Reorders `shapes` so that neighbours follow each other, and cuts them into groups of at most
/// `most`. Returns the end index of each group, in order.
[[nodiscard]] std::vector<std::size_t> sort_into_groups(std::span<Capsule> shapes,
                                                        std::size_t most);

}  // namespace mneme::internal
