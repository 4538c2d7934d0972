// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Planners of a benchmark: mneme's own, and OMPL's where it was built in.
#pragma once

#include "mneme/benchmark.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::app {

/// mneme's planners and those of OMPL, also where it is not built in.
[[nodiscard]] std::vector<BenchPlanner> bench_planners();
/// Names of all planners and samplers that `mneme bench run` knows.
[[nodiscard]] SuiteNames bench_names();

/// Writes what Lightning or Thunder makes of solved paths. Errors: io; built without OMPL.
[[nodiscard]] Result<void> train_experience(std::string_view planner, const Robot& robot,
                                            std::span<const Path> paths, const std::string& file);

/// Errors: a planner or sampler that this build does not have; a sampler of OMPL's with a planner
/// that is not.
[[nodiscard]] Result<void> check_names(const SolveSettings& settings);

/// solve() with the planner of the case, whoever's it is. What of OMPL is as in the paper has
/// OMPL's defaults; the case's own experience is a file of train_experience.
[[nodiscard]] Result<SolveResult> solve_case(const Problem& problem, Database* database,
                                             const BenchCase& bench_case);

}  // namespace mneme::app
