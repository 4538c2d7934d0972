// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Planners of a benchmark: mneme's own, and OMPL's where it was built in.
#pragma once

#include <string>
#include <vector>

#include "mneme/benchmark.h"

namespace mneme::app {

/// Planners and samplers that `mneme bench run` knows, those of OMPL also where it is not built in.
[[nodiscard]] SuiteNames bench_names();
/// True for planners that this build lacks: those of OMPL, if it was built without.
[[nodiscard]] bool is_missing_planner(const std::string& planner);

/// solve() with the planner of `settings`, whoever's it is. With `is_ompl_as_in_paper` those of
/// OMPL have OMPL's defaults.
[[nodiscard]] Result<SolveResult> solve_with_any(const Problem& problem, Database* database,
                                                 const SolveSettings& settings,
                                                 bool is_ompl_as_in_paper);

}  // namespace mneme::app
