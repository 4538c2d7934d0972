// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Links that no joint of a planning group moves against each other, and pairs that more joints
/// part. `wide` is the robot with more joints in its group.
#pragma once

#include "mneme/robot.h"

#include <utility>
#include <vector>

namespace mneme::internal {

/// Returns the links that no joint of the group moves against `link`, and `link` itself.
[[nodiscard]] std::vector<int> rigid_with(const Robot& robot, int link);

/// Returns the pairs that `wide` checks and `robot` does not.
[[nodiscard]] std::vector<std::pair<int, int>> parted_pairs(const Robot& wide, const Robot& robot);

/// Returns the pairs that a joint connects which only `wide` moves.
[[nodiscard]] std::vector<std::pair<int, int>> connected_pairs(const Robot& wide,
                                                               const Robot& robot);

/// Returns the parted pairs that touch wherever the joints are that only `wide` moves, such as the
/// bars of a linkage: at some values of these joints, with the others in the middle.
[[nodiscard]] std::vector<std::pair<int, int>> linked_pairs(const Robot& wide, const Robot& robot);

}  // namespace mneme::internal
