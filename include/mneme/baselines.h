// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Other methods that use memory, re-created on mneme's databases and kernels for comparison. Only
/// for benchmarks: a rival may return paths that are not verified.
#pragma once

#include "mneme/pipeline.h"

#include <span>
#include <string_view>

namespace mneme {

/// Adds to samplers() the baselines, which use the same databases as "gl": "pooled",
/// "nearest_scenes" and "cvae". Call this function before planning.
void add_baseline_samplers();

/// A method for comparison, which a suite names in place of a planner. To add one:
/// src/baselines/NAME.cpp, a declaration and a row in src/baselines/rivals.cpp, a test.
struct Rival {
  std::string_view name;
  std::string_view summary;
  /// Solves a problem like mneme::solve(), with the whole paths that the database holds.
  /// SolveSettings::planner is ignored. Errors: those of solve().
  Result<SolveResult> (*solve)(const Problem& problem, Database* database,
                               const SolveSettings& settings) = nullptr;
};
[[nodiscard]] std::span<const Rival> rivals();
/// Null if there is none of that name.
[[nodiscard]] const Rival* find_rival(std::string_view name);

}  // namespace mneme
