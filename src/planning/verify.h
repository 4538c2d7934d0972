// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "mneme/planning.h"

namespace mneme::internal {

/// True if the motion is free at kVerificationRefinement times the resolution. `is_at_end`: it
/// touches the start or the goal of its path, which may lie closer to contact than
/// kVerificationMargin: then it needs no margin.
[[nodiscard]] bool is_motion_verified(const CollisionChecker& checker, std::span<const float> from,
                                      std::span<const float> to, bool is_at_end,
                                      CheckCounters& counters);

}  // namespace mneme::internal
