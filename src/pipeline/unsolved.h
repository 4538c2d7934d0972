// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Problems that were searched in vain.
#pragma once

#include "pipeline/resolve_goals.h"

#include <optional>

namespace mneme::internal {

/// Returns the failure of a remembered search for exactly this problem, if that search was given at
/// least as much time, or as many iterations, as the query allows. Exact means equal numbers of
/// robot, scene, start, goals, constraints, planner and settings of the checker. Cost: one lookup;
/// if start and goals are known, also a hash of the scene.
[[nodiscard]] std::optional<PlanResult> find_unsolved(const Query& query);

/// Queues a search in vain for the database, if the query may remember and the search was long.
void remember_unsolved(const ResolvedQuery& resolved, const PlanResult& plan);

}  // namespace mneme::internal
