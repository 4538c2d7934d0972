// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Where the links are: forward kinematics over a sorted tree.
#pragma once

#include <span>
#include <vector>

#include "mneme/robot.h"

namespace mneme::internal {

/// Poses of all links in the root link's frame. `group[i]` takes the value `q[i]`; other joints
/// follow or stand at their fixed values. Links and joints are in tree order.
[[nodiscard]] std::vector<Transform> forward_kinematics(std::span<const Joint> joints,
                                                        std::span<const int> group,
                                                        std::span<const double> q);

}  // namespace mneme::internal
