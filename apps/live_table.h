// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Progress of a benchmark: a table that grows on a terminal, otherwise a line now and then.
#pragma once

#include <chrono>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mneme/report.h"

#include "console.h"

namespace mneme::app {

/// to_table() with names that a terminal may be shown.
[[nodiscard]] std::string printable_table(std::vector<SetSummary> summaries);

/// Not thread-safe.
class LiveTable {
 public:
  explicit LiveTable(std::size_t total);
  LiveTable(const LiveTable&) = delete;
  LiveTable& operator=(const LiveTable&) = delete;
  /// Removes the table.
  ~LiveTable();

  /// Shows `rows`, the last of which has just come. Cheap to call often.
  void update(std::span<const BenchmarkRow> rows);

 private:
  void draw(std::span<const BenchmarkRow> rows);
  void erase();

  using Clock = std::chrono::steady_clock;
  std::int64_t total_;
  Progress progress_;  ///< for what is no terminal, and the bar below the table
  bool is_terminal_;
  int lines_ = 0;  ///< of the table that is shown
  Clock::time_point shown_ = Clock::now();
};

/// The first lines of `table`, each cut to `width` columns; a last line says how many are missing.
[[nodiscard]] std::string fit_table(std::string_view table, int width, int height);

}  // namespace mneme::app
