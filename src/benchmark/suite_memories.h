// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A suite made ready to run: problems read, memories learned and opened.
#pragma once

#include "mneme/benchmark.h"

#include <string>
#include <vector>

namespace mneme::internal {

struct ReadySuite {
  BenchPlan plan;
  std::vector<MemoryRow> memories;
  bool is_interrupted = false;  ///< while it learned: nothing is ready
};
/// Reads the problems of `suite`, learns the memories that its settings draw from into
/// `directory`/NAME.db, unless they are there, and opens them. Planners that this build lacks are
/// left out. `known` are the memories of an earlier run; their times stand for what is not learned
/// again. Errors: a planner with experience of its own and a memory that is not learned from
/// problems.
[[nodiscard]] Result<ReadySuite> prepare_suite(const Suite& suite, const std::string& directory,
                                               const std::vector<MemoryRow>& known, int jobs,
                                               const SuiteHooks& hooks);

/// The database of `memory`: its file, or `directory`/NAME.db if it is learned.
[[nodiscard]] std::string memory_file(const SuiteMemory& memory, const std::string& directory);

}  // namespace mneme::internal
