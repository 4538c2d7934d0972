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

/// Pairs of links whose rigid bodies one moving joint connects.
[[nodiscard]] LinkPairs find_neighbours(std::span<const Link> links, std::span<const Joint> joints,
                                        std::span<const int> group);

/// Pairs of links with shapes, first < second, that the joints of `group` and those that follow
/// them move against each other, except `allowed` ones (in any order); only those whose second link
/// is `first_second` or a later one. Other joints weld links into bodies.
[[nodiscard]] LinkPairs derive_self_pairs(std::span<const Link> links,
                                          std::span<const Joint> joints, std::span<const int> group,
                                          const LinkPairs& allowed, int first_second = 0);

}  // namespace mneme::internal
