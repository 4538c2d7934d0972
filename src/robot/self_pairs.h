// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Pairs of links that are checked against each other.
#pragma once

#include "mneme/robot.h"

#include <span>
#include <utility>
#include <vector>

namespace mneme::internal {

using LinkPairs = std::vector<std::pair<int, int>>;

/// Returns pairs of links whose rigid bodies are connected by one moving joint.
[[nodiscard]] LinkPairs find_neighbours(std::span<const Link> links, std::span<const Joint> joints,
                                        std::span<const int> group);

/// Returns pairs of links with shapes, first < second, that move relative to each other, except
/// `allowed` ones (in any order). Joints that do not move weld links into bodies. Only pairs whose
/// second link is `first_second` or later.
[[nodiscard]] LinkPairs derive_self_pairs(std::span<const Link> links,
                                          std::span<const Joint> joints, std::span<const int> group,
                                          const LinkPairs& allowed, int first_second = 0);

}  // namespace mneme::internal
