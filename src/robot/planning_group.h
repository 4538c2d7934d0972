// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Selection of the joints to plan for.
#pragma once

#include "mneme/robot.h"

#include <span>
#include <string>
#include <vector>

namespace mneme::internal {

/// Returns the index of a movable joint that follows no other. The error lists all such joints.
[[nodiscard]] Result<int> find_free_joint(std::span<const Joint> joints, const std::string& name);

/// Returns the names of the free joints (see is_free()) between two links, in tree order. Links and
/// joints are in tree order.
[[nodiscard]] std::vector<std::string> joints_between(std::span<const Link> links,
                                                      std::span<const Joint> joints, int base,
                                                      int tip);

struct PlanningGroup {
  std::vector<int> joints;  ///< indices, in the order of a configuration
  std::string tip = {};     ///< see Robot::tip()
};
/// Returns the joints that `options` select. `parts` are in tree order.
[[nodiscard]] Result<PlanningGroup> choose_group(const Robot::Parts& parts,
                                                 const RobotOptions& options);

}  // namespace mneme::internal
