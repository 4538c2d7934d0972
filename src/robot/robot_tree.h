// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// From parts in any order to a checked tree in order, whose joints may follow others.
#pragma once

#include "mneme/robot.h"

#include <tl/expected.hpp>

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mneme::internal {

/// Index of the link of this name, if there is one.
[[nodiscard]] std::optional<int> find_link(std::span<const Link> links, std::string_view name);

/// Makes every joint follow one that follows none itself, and frees fixed joints from following.
/// Returns the joint that cannot follow, and why: a loop, no such joint, numbers that are not
/// finite, or a position that jumps where a continuous joint wraps round.
[[nodiscard]] std::optional<std::pair<int, std::string>> fold_mimics(std::vector<Joint>& joints);

/// The fault in the spheres and capsules of a link, or nothing: numbers that are not finite,
/// radii below 0, or what is farther away or larger than any robot.
[[nodiscard]] std::optional<std::string> describe_shape_fault(const Link& link);

/// A fault in a robot's parts, with the index of the link or joint that has it, or -1.
struct PartsFault {
  std::string message;
  int link = -1;
  int joint = -1;
};

/// Checks names, numbers and the tree; makes axes unit vectors; folds chains of joints that follow
/// each other; sorts links and joints depth first, children in the order of their joints, so that
/// joint `i` carries link `i + 1`. Sorting what is sorted changes nothing.
[[nodiscard]] tl::expected<Robot::Parts, PartsFault> sort_tree(Robot::Parts parts);

}  // namespace mneme::internal
