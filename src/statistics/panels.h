// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Runs in groups, and which of them are compared: what the figures and tables of a report share.
#pragma once

#include "mneme/statistics.h"

#include <algorithm>
#include <functional>
#include <span>
#include <string>
#include <vector>

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

/// The different texts that `member` of `items` has, in order of appearance.
template <class Items, class Member>
[[nodiscard]] std::vector<std::string> different(const Items& items, Member member) {
  std::vector<std::string> all;
  for (const auto& item : items) {
    const std::string& text = std::invoke(member, item);
    if (std::ranges::find(all, text) == all.end()) all.push_back(text);
  }
  return all;
}

/// In order of first appearance; one per set, or per problem.
[[nodiscard]] std::vector<Panel> make_panels(std::span<const BenchmarkRow> rows, bool by_problem);

/// "gl, paper", or "gl" without a setting.
[[nodiscard]] std::string short_label(const Series& series);
/// Letters, digits, '-' and '.'; anything else becomes '_'.
[[nodiscard]] std::string file_name(std::string_view text);

struct Comparison {
  std::string kind;  ///< "sampler", "setting" or "planner": what differs
  const Series* other = nullptr;
  const Series* reference = nullptr;
  PairedRatio ratio;
};

/// Each sampler with `baseline` under the same planner and setting, or under another setting if
/// that one has no baseline; each setting with the first one; mneme's planners with OMPL's of the
/// same name. Comparisons without pairs are left out.
[[nodiscard]] std::vector<Comparison> compare_series(const Panel& panel,
                                                     const std::string& baseline);

/// "≥ 27.1 (4.80 to 33.0)"; "open" if both sides failed, so that the ratio says nothing.
[[nodiscard]] std::string format_ratio(const TimeRatio& ratio);
/// "rrt_connect, gl, paper"
[[nodiscard]] std::string series_name(const Series& series);

}  // namespace mneme::internal
