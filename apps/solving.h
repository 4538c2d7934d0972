// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Planners and samplers by name: mneme's own, and those of OMPL where it was built in.
#pragma once

#include <string>
#include <vector>

#include "mneme/pipeline.h"

namespace mneme::app {

/// mneme's planners, then "ompl:NAME" for each of OMPL's.
[[nodiscard]] std::vector<std::string> planner_names();
/// mneme's samplers, then OMPL's samplers of valid states, which only its PRM takes.
[[nodiscard]] std::vector<std::string> all_sampler_names();

/// solve(), or solve_with_ompl() for a planner "ompl:NAME"; `as_in_paper` is OmplSettings'.
[[nodiscard]] Result<SolveResult> solve_by_name(const Problem& problem, Database* database,
                                                const SolveSettings& settings,
                                                bool as_in_paper = false);

}  // namespace mneme::app
