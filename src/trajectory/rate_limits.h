// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What limits of joints may be.
#pragma once

#include "mneme/trajectory.h"

namespace mneme::internal {

/// Error: invalid, naming the joint, unless there are limits within range for each of the group.
[[nodiscard]] Result<void> check_rate_limits(const Robot& robot, const RateLimits& limits);

}  // namespace mneme::internal
