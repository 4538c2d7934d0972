// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Learning with progress, as `mneme learn`, `mneme demo` and suites do it.
#pragma once

#include "mneme/learning.h"

#include <span>
#include <string>
#include <vector>

namespace mneme::app {

/// The primitives that cover the grid; fewer if it is interrupted.
[[nodiscard]] std::vector<PrimitiveKey> cover_grid(const PrimitiveGrid& grid, std::uint64_t seed);

/// Says what is learned, lets the run heed an interrupt and shows how far it is.
void watch_learning(LearnRun& run, const std::string& what);

/// Learns `keys` with progress on standard error until it is done or interrupted.
[[nodiscard]] Result<LearnSummary> learn_with_progress(const Robot& robot,
                                                       std::span<const PrimitiveKey> keys,
                                                       Database& database, LearnJob job);

/// Learns from problems in the same way, and prints which of them have no path.
[[nodiscard]] Result<LearnSummary> learn_with_progress(std::span<const Problem> problems,
                                                       const MemorySettings& memory,
                                                       Database& database, ProblemLesson lesson);

/// The similarity errors that random primitives of the grid meet in the database; infinite if it is
/// empty.
[[nodiscard]] Result<Coverage> measure_coverage(const Database& database,
                                                const PrimitiveGrid& grid);

}  // namespace mneme::app
