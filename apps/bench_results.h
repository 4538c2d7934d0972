// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Running a benchmark with progress, and what is said of its rows at the end.
#pragma once

#include <vector>

#include "bench_runs.h"
#include "exit_codes.h"
#include "row_file.h"

namespace mneme::app {

/// Runs what `file` does not hold yet and adds it there. False if it was interrupted. Errors: rows
/// of other settings; what the runs say.
[[nodiscard]] Result<bool> run_with_progress(BenchPlan& plan, RowFile& file);

/// One summary per set, planner, sampler and setting, as a table or as JSON.
void print_bench_results(const std::vector<BenchmarkRow>& rows, bool is_json);
/// Failure, with a message, if a path did not survive the independent check.
[[nodiscard]] ExitCode judge_rows(const std::vector<BenchmarkRow>& rows);

}  // namespace mneme::app
