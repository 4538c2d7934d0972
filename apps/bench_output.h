// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Benchmarks on the console: a table that grows while they run, and results at the end.
#pragma once

#include "mneme/benchmark.h"

#include "commands.h"

#include <nlohmann/json_fwd.hpp>

#include <vector>

namespace mneme::app {

/// Returns a callback that shows the runs of a benchmark as they end: as a table that grows on a
/// terminal, otherwise as a line now and then. Destroying the callback ends the table.
[[nodiscard]] OnRows show_rows();

/// One summary per set, planner, sampler and setting, and the problems that no summary covers.
[[nodiscard]] nlohmann::ordered_json summary_json(const std::vector<BenchmarkRow>& rows);
/// Prints the summaries as a table or as JSON.
void print_bench_results(const std::vector<BenchmarkRow>& rows, bool is_json);
/// Failure, with a message, if a path did not survive the independent check.
[[nodiscard]] ExitCode judge_rows(const std::vector<BenchmarkRow>& rows);

}  // namespace mneme::app
