// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Joints that follow others.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "mneme/robot.h"

namespace mneme::internal {

/// Makes every joint follow one that follows none itself, and frees fixed joints from following.
/// Returns the joint that cannot follow, and why: a loop, no such joint, numbers that are not
/// finite, or a position that jumps where a continuous joint wraps round.
[[nodiscard]] std::optional<std::pair<int, std::string>> fold_mimics(std::vector<Joint>& joints);

/// Per joint, whether joints of `group` move it, itself or by way of one that it follows.
[[nodiscard]] std::vector<bool> find_moving(std::span<const Joint> joints,
                                            std::span<const int> group);

}  // namespace mneme::internal
