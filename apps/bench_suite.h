// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A suite made ready to run: problems read, databases opened or learned.
#pragma once

#include <string>
#include <vector>

#include "bench_runs.h"

namespace mneme::app {

struct ReadySuite {
  BenchPlan plan;
  std::vector<MemoryRow> memories;
  bool is_interrupted = false;  ///< while it learned: nothing is ready
};

/// Reads the problems of `suite`, learns the memories that its settings draw from into
/// `directory`/NAME.db (what is there already is kept), and opens them. `known` are the memories of
/// an earlier run; their times stand for what is not learned again. Learning uses `jobs` threads.
[[nodiscard]] Result<ReadySuite> make_ready(const Suite& suite, const std::string& directory,
                                            const std::vector<MemoryRow>& known, int jobs);

/// The problems of `found`; their warnings become notes, each once.
[[nodiscard]] Result<std::vector<LoadedProblem>> load_bench_problems(
    const std::vector<SuiteProblems>& found, const ProblemOptions& overrides);

}  // namespace mneme::app
