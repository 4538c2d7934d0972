// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The functions in the table of rivals.
#pragma once

#include "mneme/baselines.h"

#include "pipeline/query.h"

namespace mneme::internal {

// src/baselines/path_cache.cpp
[[nodiscard]] Result<SolveResult> fetch_fastest(const Problem& problem, Database* database,
                                                const SolveSettings& settings);
[[nodiscard]] Result<SolveResult> fetch_nearest(const Problem& problem, Database* database,
                                                const SolveSettings& settings);
[[nodiscard]] Result<SolveResult> fetch_free(const Problem& problem, Database* database,
                                             const SolveSettings& settings);
// src/baselines/ert_connect.cpp
[[nodiscard]] Result<SolveResult> solve_by_ert_connect(const Problem& problem, Database* database,
                                                       const SolveSettings& settings);

/// The settings with a planner of mneme instead of the rival's name.
[[nodiscard]] inline SolveSettings with_own_planner(SolveSettings settings) {
  settings.planner = SolveSettings{}.planner;
  return settings;
}

}  // namespace mneme::internal
