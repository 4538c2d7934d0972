// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Problems whose robot moves at the start or at the goal.
#pragma once

#include "mneme/pipeline.h"

#include <functional>
#include <string>

namespace mneme::internal {

/// Returns the result of a query that ended after `preparation_s` seconds, before its search.
[[nodiscard]] SolveResult unplanned(const SolveSettings& settings, PlanStatus status,
                                    std::string message, double preparation_s);

/// Plans, by `solve_at_rest` within the time that is left, from where the robot can stop to where
/// it has to start for the goal, both on the straight line of the velocity there, and adds these
/// motions to the path. The result is PlanStatus::invalid_start or invalid_goal if limits prevent
/// such a motion, or it is not proven free; a note names goals without one beside others. Its times
/// include those of the ends. Error: an end velocity with pose goals.
[[nodiscard]] Result<SolveResult> solve_moving(
    const Problem& problem, const SolveSettings& settings,
    const std::function<Result<SolveResult>(const Problem&, const SolveSettings&)>& solve_at_rest);

}  // namespace mneme::internal
