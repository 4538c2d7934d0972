// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/benchmark.h"
#include "mneme/report.h"

#include "base/fail.h"

#include <cerrno>
#include <cstring>
#include <filesystem>

namespace mneme {
namespace {

/// Room for more than a million runs.
constexpr std::size_t kMaxCsvBytes = std::size_t{256} << 20;

}  // namespace

Result<std::vector<BenchmarkRow>> read_rows(const std::string& path) {
  const std::string text = MNEME_TRY(read_file(path, kMaxCsvBytes));
  return parse_csv(text, path).map([](CsvRuns runs) { return std::move(runs.rows); });
}

Result<std::vector<MemoryRow>> read_memories(const std::string& path) {
  std::error_code missing;
  if (!std::filesystem::exists(path, missing)) return std::vector<MemoryRow>();
  const std::string text = MNEME_TRY(read_file(path, kMaxCsvBytes));
  return parse_memory_csv(text, path);
}

Result<void> RowFile::open(const std::string& csv, bool is_resumed) {
  std::error_code missing;
  if (is_resumed && std::filesystem::exists(csv, missing)) rows_ = MNEME_TRY(read_rows(csv));
  path_ = csv;
  return write_all();
}

Result<void> RowFile::add(const BenchmarkRow& row) {
  rows_.push_back(row);
  if (path_.empty()) return {};
  file_ << to_csv_line(row);
  return flush();
}

Result<void> RowFile::sort(const BenchPlan& plan) {
  sort_rows(plan, rows_);
  return write_all();
}

Result<void> RowFile::write_all() {
  if (path_.empty()) return {};
  MNEME_TRY(write_file(path_, to_csv(rows_)));
  file_ = std::ofstream(path_, std::ios::app);
  return flush();
}

Result<void> RowFile::flush() {
  if (file_.flush()) return {};
  return fail(ErrorCode::io, "cannot write '{}': {}", path_, std::strerror(errno));
}

Result<bool> run_bench(BenchPlan& plan, RowFile& file, const OnRows& on_rows) {
  MNEME_TRY(check_same_settings(plan, file.rows()));
  const std::vector<BenchmarkRow> done = file.rows();
  const std::size_t total = plan.run_count();
  const auto take = [&](const BenchmarkRow& row, const SolveResult&) -> Result<void> {
    MNEME_TRY(file.add(row));
    if (on_rows) on_rows(file.rows(), total);
    return {};
  };
  const bool is_complete = MNEME_TRY(run_bench(plan, done, take));
  MNEME_TRY(file.sort(plan));
  return is_complete;
}

}  // namespace mneme
