// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Tables of benchmarks, written as aligned text or as HTML.
#pragma once

#include "mneme/statistics.h"

#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

struct TableCell {
  std::string text = {};
  bool is_bad = false;  ///< highlighted in HTML
  std::optional<double> exact =
      {};  ///< the number with all its digits, for the attribute `data-value`
};

/// Lines of cells below a header. The first `name_columns` are aligned left, the others right.
struct Table {
  std::size_t name_columns = 0;
  std::vector<std::string> header;
  std::vector<std::vector<TableCell>> lines;
};

[[nodiscard]] std::string to_text(const Table& table);
/// A card with a table of class `kind`; empty if the table has no lines.
[[nodiscard]] std::string to_html(const Table& table, std::string_view kind);

/// One line per summary. `columns` are names of the table in tables.cpp, names first.
[[nodiscard]] Table summary_table(std::span<const SetSummary> summaries,
                                  std::initializer_list<std::string_view> columns);
/// One line per ratio, without the set.
[[nodiscard]] Table ratio_table(std::span<const SeriesRatio> ratios);
[[nodiscard]] Table memory_table(std::span<const MemoryRow> memories);
/// One line per setting: its name, the values that differ from the defaults, the time limit.
[[nodiscard]] Table settings_table(std::span<const BenchmarkRow> rows);

/// 1-based position of a nearest-rank percentile among `count` > 0 sorted values.
[[nodiscard]] int nearest_rank(int percent, int count);
/// True if that percentile is a failure: the time is a lower bound.
[[nodiscard]] bool is_censored(const TimeSummary& times, int percent);
/// Milliseconds with three significant digits or more.
[[nodiscard]] std::string format_ms(double seconds);
/// "≥ 27.1 (4.80 to 33.0)"; "open" if both sides failed, so that the ratio says nothing.
[[nodiscard]] std::string format_ratio(const TimeRatio& ratio);

}  // namespace mneme::internal
