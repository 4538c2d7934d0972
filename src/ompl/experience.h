// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mneme/path.h"

#include <ompl/base/Planner.h>

#include <span>
#include <string>
#include <string_view>

namespace mneme::ompl {

inline constexpr std::string_view kLightning = "Lightning";
inline constexpr std::string_view kThunder = "Thunder";

/// Lightning or Thunder: repairs the experience in `file` (empty: none) and plans from scratch with
/// RRTConnect, in two threads, until either has a path. `range` as for set_range. Errors: io, and
/// corrupt if OMPL cannot read the file.
[[nodiscard]] Result<::ompl::base::PlannerPtr> make_experience_planner(
    std::string_view name, const ::ompl::base::SpaceInformationPtr& information,
    const std::string& file, double range);

/// Writes the experience of Lightning or Thunder from solved paths of the robot. Errors: io; paths
/// that are none of the robot's.
[[nodiscard]] Result<void> train_experience(std::string_view planner, const Robot& robot,
                                            std::span<const Path> paths, const std::string& path);

}  // namespace mneme::ompl
