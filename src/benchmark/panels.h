// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Runs in groups: what the figures and tables of a report share.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "mneme/report.h"

namespace mneme::internal {

/// All runs of one planner, sampler and setting in a panel.
struct Series {
  std::string planner;
  std::string sampler;
  std::string setting;
  std::vector<BenchmarkRow> rows;  ///< on problems whose start and goal are valid
  SetSummary summary;
  std::vector<double> solved_times;  ///< planning times of successes, sorted, seconds
  std::vector<double> limits;        ///< time limits of failures, sorted, seconds

  [[nodiscard]] int run_count() const { return summary.valid; }
};

/// One figure's worth of series.
struct Panel {
  std::string name;            ///< of the set, or of set and problem
  std::vector<Series> series;  ///< planners together, in order of appearance
  double longest_limit = 0;    ///< of all runs, seconds
};

/// In order of first appearance; one per set, or per problem.
[[nodiscard]] std::vector<Panel> make_panels(std::span<const BenchmarkRow> rows, bool by_problem);

/// "gl, paper", or "gl" without a setting.
[[nodiscard]] std::string short_label(const Series& series);
/// Letters, digits, '-' and '.'; anything else becomes '_'.
[[nodiscard]] std::string file_name(std::string_view text);

}  // namespace mneme::internal
