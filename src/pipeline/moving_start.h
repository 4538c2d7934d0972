// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Problems whose robot moves at the start.
#pragma once

#include "mneme/pipeline.h"

#include <functional>

namespace mneme::internal {

/// Plans, by `solve_at_rest`, from where the robot can stop without leaving the straight line of
/// its velocity, and puts that motion before the path. The result is PlanStatus::invalid_start if
/// the robot cannot stop within its limits, or the motion is not proven free.
[[nodiscard]] Result<SolveResult> solve_moving(
    const Problem& problem, const SolveSettings& settings,
    const std::function<Result<SolveResult>(const Problem&)>& solve_at_rest);

}  // namespace mneme::internal
