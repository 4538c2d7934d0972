// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Where the links are: forward kinematics over a sorted tree.
#pragma once

#include "mneme/robot.h"

#include <span>
#include <vector>

namespace mneme::internal {

/// Pose of the joint's child in its frame at `value`.
[[nodiscard]] Transform joint_motion(const Joint& joint, double value);

/// Values of all joints: `group[i]` takes the value `q[i]`; other joints follow or stand at their
/// fixed values.
[[nodiscard]] std::vector<double> joint_values(std::span<const Joint> joints,
                                               std::span<const int> group,
                                               std::span<const double> q);

/// Poses of all links in the root link's frame, with the joints at joint_values(). Links and
/// joints are in tree order.
[[nodiscard]] std::vector<Transform> forward_kinematics(std::span<const Joint> joints,
                                                        std::span<const int> group,
                                                        std::span<const double> q);

}  // namespace mneme::internal
