// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Preparation of a suite: its problems and memories.
#pragma once

#include "mneme/benchmark.h"

#include <string>
#include <vector>

namespace mneme::internal {

struct ReadySuite {
  BenchPlan plan;
  std::vector<MemoryRow> memories;
  bool is_interrupted = false;  ///< interrupted while learning: the suite cannot run
};
/// Loads the problems of `suite`, learns missing memories into `directory`/NAME.db, and opens all
/// databases. Planners that this build lacks are skipped. `known` are memories of an earlier run:
/// their learning times are kept. Errors: those of run_suite().
[[nodiscard]] Result<ReadySuite> prepare_suite(const Suite& suite, const std::string& directory,
                                               const std::vector<MemoryRow>& known, int jobs,
                                               const SuiteHooks& hooks);

/// The database of `memory`: its file, or `directory`/NAME.db if it is learned.
[[nodiscard]] std::string memory_file(const SuiteMemory& memory, const std::string& directory);

}  // namespace mneme::internal
