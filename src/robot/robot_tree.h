// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// From parts in any order to a checked tree in order.
#pragma once

#include <string>

#include <tl/expected.hpp>

#include "mneme/robot.h"

namespace mneme::internal {

/// What is wrong with a robot's parts, and with which of them: -1 where it is not one link or one
/// joint.
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
