// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Which joints to plan for.
#pragma once

#include "mneme/robot.h"

#include <span>
#include <string>
#include <vector>

namespace mneme::internal {

/// True if the joint moves and follows no other.
[[nodiscard]] bool is_free(const Joint& joint);

/// The index of a joint that moves and follows no other, or a message that lists those that do.
[[nodiscard]] Result<int> find_free_joint(std::span<const Joint> joints, const std::string& name);

/// Names of the joints on the way from one link to another, in tree order, that move and follow no
/// other. Links and joints are in tree order.
[[nodiscard]] std::vector<std::string> joints_between(std::span<const Link> links,
                                                      std::span<const Joint> joints, int base,
                                                      int tip);

/// Indices of the joints that `options` ask for, in the order of a configuration; see RobotOptions.
/// `parts` are in tree order.
[[nodiscard]] Result<std::vector<int>> choose_group(const Robot::Parts& parts,
                                                    const RobotOptions& options);

}  // namespace mneme::internal
