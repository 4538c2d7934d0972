// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Which links can touch each other.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "mneme/robot.h"

namespace mneme::internal {

/// Pairs of links with shapes, first < second, that the joints of `group` move against each other,
/// except those whose rigid bodies one such joint connects. Fixed joints, and joints outside the
/// group, weld links into bodies.
[[nodiscard]] std::vector<std::pair<int, int>> derive_self_pairs(std::span<const Link> links,
                                                                 std::span<const Joint> joints,
                                                                 std::span<const int> group);

}  // namespace mneme::internal
