// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What is seen of a benchmark: its rows on disk as they come, a table that grows on a terminal,
/// what is said of the rows at the end, and the files that are made of them.
#pragma once

#include "mneme/benchmark.h"

#include "commands.h"
#include "console.h"

#include <nlohmann/json_fwd.hpp>

#include <chrono>
#include <cstddef>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::app {

/// Of a CSV file that is read: more than a million runs.
inline constexpr std::size_t kMaxCsvBytes = std::size_t{256} << 20;

/// The rows of a CSV file that `mneme bench run` wrote.
[[nodiscard]] Result<std::vector<BenchmarkRow>> read_rows(const std::string& path);

class RowFile {
 public:
  /// Opens `csv`, if it is not empty, for the rows to come. With `is_resumed` those that it holds
  /// are kept; a broken last line is left aside.
  Result<void> open(const std::string& csv, bool is_resumed);
  Result<void> add(const BenchmarkRow& row);
  /// Puts `rows` in the place of all that the file has.
  Result<void> replace(std::vector<BenchmarkRow> rows);

  [[nodiscard]] const std::vector<BenchmarkRow>& rows() const { return rows_; }

 private:
  Result<void> write_all();
  Result<void> flush();

  std::string path_;
  std::ofstream file_;
  std::vector<BenchmarkRow> rows_;
};

/// Runs what `file` does not hold yet and adds it there. False if it was interrupted. Errors: rows
/// of other settings; what the runs say.
[[nodiscard]] Result<bool> run_with_progress(BenchPlan& plan, RowFile& file);

/// One summary per set, planner, sampler and setting, and the problems that none is of.
[[nodiscard]] nlohmann::ordered_json summary_json(const std::vector<BenchmarkRow>& rows);
/// The same as a table or as JSON.
void print_bench_results(const std::vector<BenchmarkRow>& rows, bool is_json);
/// Failure, with a message, if a path did not survive the independent check.
[[nodiscard]] ExitCode judge_rows(const std::vector<BenchmarkRow>& rows);

/// Writes the page to `path` and its figures beside it, as PAGE_FIGURE.svg.
[[nodiscard]] Result<void> write_report(const std::string& path, const BenchmarkReport& report);
/// Writes a log per problem into `directory`, which is made if it is missing.
[[nodiscard]] Result<void> write_ompl_logs(const std::string& directory,
                                           std::span<const BenchmarkRow> rows);
/// The memories that a suite wrote down; none if there is no such file.
[[nodiscard]] Result<std::vector<MemoryRow>> read_memories(const std::string& path);

}  // namespace mneme::app
