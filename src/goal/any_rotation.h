// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Tells a pose out of reach from an impossible rotation.
#pragma once

#include "mneme/goal.h"

#include <optional>
#include <span>

namespace mneme::internal {

/// Searches for a configuration that brings the link to the goal's position with any rotation.
/// Returns the distance of the closest one, metres, 0 if the position is reached; nothing if
/// IkSettings::is_over ended the search. Cost: at most that of `settings.seeds` or 1024 seeds, 16
/// seeds where the position is easy to reach.
[[nodiscard]] std::optional<double> find_gap_with_any_rotation(const InverseKinematics& kinematics,
                                                               PoseGoal goal,
                                                               std::span<const double> near,
                                                               IkSettings settings);

}  // namespace mneme::internal
