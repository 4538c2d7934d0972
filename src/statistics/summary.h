// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What tables and charts share: runs in groups, which of their order statistics are failures, and
/// text with aligned columns.
#pragma once

#include "mneme/statistics.h"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace mneme::internal {

/// All runs of one problem, planner and sampler.
struct RunGroup {
  std::string problem;
  std::string planner;
  std::string sampler;
  TimeSummary times;
  int valid = 0;  ///< runs whose path passed the independent check
};
/// In order of first appearance.
[[nodiscard]] std::vector<RunGroup> group_runs(std::span<const BenchmarkRow> rows);

/// 1-based position of a nearest-rank percentile among `count` > 0 sorted values.
[[nodiscard]] int nearest_rank(int percent, int count);
/// True if that percentile is a failure, which is known only to take longer than its censored time.
[[nodiscard]] bool is_censored(const TimeSummary& times, int percent);

/// Milliseconds with three significant digits or more.
[[nodiscard]] std::string format_ms(double seconds);
/// The same of a percentile (100: the maximum), marked with ">" if it is censored.
[[nodiscard]] std::string format_percentile(const TimeSummary& times, int percent);

/// Lines of cells, as many in each: the first `name_columns` of them are aligned left, the others
/// right. Cells hold well-formed UTF-8 without line breaks.
[[nodiscard]] std::string text_table(const std::vector<std::vector<std::string>>& lines,
                                     std::size_t name_columns);

}  // namespace mneme::internal
