// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Groups of runs, and the pairs of groups that are compared.
#pragma once

#include "mneme/statistics.h"

#include <algorithm>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace mneme::internal {

/// All runs of one planner, sampler and setting in a panel, with their summary.
struct Series : SetSummary {
  std::vector<BenchmarkRow> rows;    ///< on problems whose start and goal are valid
  std::vector<double> solved_times;  ///< planning times of successes, sorted, seconds
};

/// The series that share a figure and a table.
struct Panel {
  std::string name;            ///< of the set, or of set and problem
  std::vector<Series> series;  ///< planners together, in order of appearance
  double longest_limit = 0;    ///< longest time limit, seconds
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

/// One summary per set, planner, sampler and setting, in order of appearance.
[[nodiscard]] std::vector<SetSummary> summarize_each(std::span<const BenchmarkRow> rows);

/// One panel per set, or per problem, in order of first appearance.
[[nodiscard]] std::vector<Panel> make_panels(std::span<const BenchmarkRow> rows, bool by_problem);

/// "gl, paper", or "gl" without a setting.
[[nodiscard]] std::string short_label(const Series& series);
/// Letters, digits, '-' and '.'; anything else becomes '_'.
[[nodiscard]] std::string file_name(std::string_view text);

/// Compares samplers, settings and planners within a panel. Each sampler is compared with
/// `baseline` under the same planner and setting, or under another setting if that one has no
/// baseline. Each setting is compared with the first one, and each of mneme's planners with OMPL's
/// of the same name. Comparisons without pairs are omitted.
[[nodiscard]] std::vector<SeriesRatio> compare_series(const Panel& panel,
                                                      const std::string& baseline);

}  // namespace mneme::internal
