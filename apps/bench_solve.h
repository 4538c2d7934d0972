// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Planners of a benchmark: mneme's own, and OMPL's where it was built in.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mneme/benchmark.h"

namespace mneme::app {

/// Planners and samplers that `mneme bench run` knows, those of OMPL also where it is not built in.
[[nodiscard]] SuiteNames bench_names();
/// True for planners that this build lacks: those of OMPL, if it was built without.
[[nodiscard]] bool is_missing_planner(const std::string& planner);

/// True of names of OMPL's planners, built in or not.
[[nodiscard]] bool is_ompl_planner(std::string_view planner);
/// True of Lightning and Thunder, which plan from experience of their own instead of a sampler's.
[[nodiscard]] bool is_experience_planner(std::string_view planner);

/// Writes what Lightning or Thunder makes of solved paths. Errors: io; built without OMPL.
[[nodiscard]] Result<void> train_experience(std::string_view planner, const Robot& robot,
                                            std::span<const Path> paths, const std::string& file);

/// Errors: a planner or sampler that this build does not have; a sampler of OMPL's with a planner
/// that is not.
[[nodiscard]] Result<void> check_names(const SolveSettings& settings);

/// solve() with the planner of `settings`, whoever's it is. With `is_ompl_as_in_paper` those of
/// OMPL have OMPL's defaults; `ompl_experience` is a file of train_experience, or empty.
[[nodiscard]] Result<SolveResult> solve_with_any(const Problem& problem, Database* database,
                                                 const SolveSettings& settings,
                                                 bool is_ompl_as_in_paper,
                                                 const std::string& ompl_experience);

}  // namespace mneme::app
