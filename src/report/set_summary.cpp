// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/report.h"

#include "report/markup.h"
#include "report/summary.h"
#include "report/text_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

namespace mneme {
namespace {

using Rows = std::vector<BenchmarkRow>;

template <class T>
T median(std::vector<T> values) {
  if (values.empty()) return {};
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(
      internal::nearest_rank(50, static_cast<int>(values.size())) - 1)];
}

SetSummary summarize_set(const std::string& set, const Rows& rows) {
  SetSummary summary;
  summary.set = set;
  summary.planner = rows.front().planner;
  summary.sampler = rows.front().sampler;
  summary.setting = rows.front().setting;
  summary.total = static_cast<int>(rows.size());
  Rows valid;
  std::vector<std::uint64_t> iterations;
  std::vector<double> simplification;
  for (BenchmarkRow row : rows) {
    if (is_invalid_problem(row)) continue;
    summary.invalid_paths += row.is_solved && !row.is_path_valid ? 1 : 0;
    iterations.push_back(row.iterations);
    if (is_success(row)) simplification.push_back(row.simplification_time_s);
    if (!is_success(row)) row.planning_time_s = row.timeout_s;
    row.is_solved = is_success(row);
    valid.push_back(std::move(row));
  }
  summary.valid = static_cast<int>(valid.size());
  summary.times = summarize(valid);
  summary.iterations_p50 = median(std::move(iterations));
  summary.simplification_p50_s = median(std::move(simplification));
  return summary;
}

/// Summaries of the rows with equal names, in order of appearance.
template <class NameSet>
void append_summaries(std::span<const BenchmarkRow> rows, NameSet&& name_set,
                      std::vector<SetSummary>& summaries) {
  using Name = std::tuple<std::string, std::string, std::string, std::string>;
  std::map<Name, std::size_t> positions;
  std::vector<Rows> groups;
  for (const BenchmarkRow& row : rows) {
    const auto position = positions.try_emplace(
        {name_set(row), row.planner, row.sampler, row.setting}, groups.size());
    if (position.second) groups.emplace_back();
    groups[position.first->second].push_back(row);
  }
  for (const Rows& group : groups) {
    summaries.push_back(summarize_set(name_set(group.front()), group));
  }
}

std::vector<std::string> cells(const SetSummary& s) {
  return {internal::single_line(s.set),
          internal::single_line(s.planner),
          internal::single_line(s.sampler),
          fmt::format("{}/{}/{}", s.times.solved, s.valid, s.total),
          std::to_string(s.invalid_paths),
          internal::format_percentile(s.times, 50),
          internal::format_percentile(s.times, 95),
          internal::format_percentile(s.times, 99),
          internal::format_percentile(s.times, 100),
          std::to_string(s.iterations_p50),
          internal::format_ms(s.simplification_p50_s)};
}

}  // namespace

bool is_invalid_problem(const BenchmarkRow& row) {
  return row.status == PlanStatus::invalid_start || row.status == PlanStatus::invalid_goal;
}

bool is_success(const BenchmarkRow& row) { return row.is_solved && row.is_path_valid; }

std::vector<SetSummary> summarize_sets(std::span<const BenchmarkRow> rows) {
  std::vector<SetSummary> summaries;
  append_summaries(
      rows, [](const BenchmarkRow& row) { return row.set; }, summaries);
  std::set<std::string> sets;
  for (const BenchmarkRow& row : rows) sets.insert(row.set);
  if (sets.size() > 1) {
    append_summaries(
        rows, [](const BenchmarkRow&) { return std::string("all"); }, summaries);
  }
  return summaries;
}

std::string to_table(std::span<const SetSummary> summaries) {
  constexpr std::size_t kNameColumns = 3;
  std::vector<std::vector<std::string>> lines = {{"set", "planner", "sampler", "solved/valid/total",
                                                  "bad paths", "p50 ms", "p95 ms", "p99 ms",
                                                  "max ms", "iterations p50", "simplify p50 ms"}};
  for (const SetSummary& summary : summaries) lines.push_back(cells(summary));
  const bool has_settings =
      std::ranges::any_of(summaries, [](const SetSummary& s) { return !s.setting.empty(); });
  if (!has_settings) return internal::text_table(lines, kNameColumns);
  lines[0].insert(lines[0].begin() + kNameColumns, "setting");
  for (std::size_t i = 0; i < summaries.size(); ++i) {
    lines[i + 1].insert(lines[i + 1].begin() + kNameColumns,
                        internal::single_line(summaries[i].setting));
  }
  return internal::text_table(lines, kNameColumns + 1);
}

}  // namespace mneme
