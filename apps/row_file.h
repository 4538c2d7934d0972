// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The rows of a benchmark, on disk as they come.
#pragma once

#include <cstddef>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mneme/benchmark.h"

namespace mneme::app {

/// Of a CSV file that is read: more than a million runs.
inline constexpr std::size_t kMaxCsvBytes = std::size_t{256} << 20;

/// The rows of a CSV file that `mneme bench run` wrote.
[[nodiscard]] Result<std::vector<BenchmarkRow>> read_rows(const std::string& path);

class RowFile {
 public:
  /// Opens `csv` and `sqlite`, where they are not empty, for the rows to come. With `is_resumed`
  /// those that the CSV file holds are kept; a broken last line is left aside.
  Result<void> open(const std::string& csv, const std::string& sqlite, bool is_resumed);
  Result<void> add(const BenchmarkRow& row);
  /// Puts `rows` in the place of all that the CSV file has; the SQLite file keeps its order.
  Result<void> replace(std::vector<BenchmarkRow> rows);

  [[nodiscard]] const std::vector<BenchmarkRow>& rows() const { return rows_; }

 private:
  Result<void> write_all();
  Result<void> flush();

  std::string path_;
  std::ofstream file_;
  std::optional<RunDatabase> database_;
  std::vector<BenchmarkRow> rows_;
};

}  // namespace mneme::app
