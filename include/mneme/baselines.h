// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What others do with the same memory, re-created on mneme's databases and kernels so that it can
/// be measured beside mneme. For benchmarks alone: a rival may return what nobody has verified.
#pragma once

#include "mneme/pipeline.h"

#include <span>
#include <string_view>

namespace mneme {

/// Adds to samplers() the baselines on the same memory: "pooled", "nearest_scenes" and "cvae". Call
/// it before planning.
void add_baseline_samplers();

/// Takes the place of a planner in a suite. To add one: src/baselines/NAME.cpp, a declaration and a
/// row in src/baselines/rivals.cpp, a test.
struct Rival {
  std::string_view name;
  std::string_view summary;
  /// Answers as solve() does, its planner aside, from rows of kinds that keep whole paths. Errors:
  /// those of solve().
  Result<SolveResult> (*solve)(const Problem& problem, Database* database,
                               const SolveSettings& settings) = nullptr;
};
[[nodiscard]] std::span<const Rival> rivals();
/// Null if there is none of that name.
[[nodiscard]] const Rival* find_rival(std::string_view name);

}  // namespace mneme
