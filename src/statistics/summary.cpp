// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "statistics/summary.h"

#include "statistics/panels.h"
#include "report/markup.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

namespace mneme::internal {
namespace {

using Rows = std::vector<BenchmarkRow>;

/// The rows of equal names, in order of appearance.
template <class NameOf>
std::vector<Rows> grouped(std::span<const BenchmarkRow> rows, NameOf&& name_of) {
  std::map<decltype(name_of(rows.front())), std::size_t> positions;
  std::vector<Rows> groups;
  for (const BenchmarkRow& row : rows) {
    const auto position = positions.try_emplace(name_of(row), groups.size());
    if (position.second) groups.emplace_back();
    groups[position.first->second].push_back(row);
  }
  return groups;
}

template <class T>
T median(std::vector<T> values) {
  if (values.empty()) return {};
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(nearest_rank(50, static_cast<int>(values.size())) - 1)];
}

SetSummary summarize_set(const std::string& set, const Rows& rows) {
  SetSummary summary;
  summary.set = set;
  summary.planner = rows.front().planner;
  summary.sampler = rows.front().sampler;
  summary.setting = rows.front().setting;
  summary.total = static_cast<int>(rows.size());
  Rows valid;
  std::vector<std::uint64_t> iterations, states;
  std::vector<double> simplification;
  double lengths = 0, durations_s = 0;
  for (BenchmarkRow row : rows) {
    if (is_invalid_problem(row)) continue;
    summary.invalid_paths += row.is_solved && !row.is_path_valid ? 1 : 0;
    iterations.push_back(row.iterations);
    states.push_back(row.states_checked);
    row.is_solved = is_success(row);
    if (row.is_solved) {
      simplification.push_back(row.simplification_time_s);
      lengths += row.path_length;
      durations_s += row.duration_s;
    } else {
      row.planning_time_s = row.total_time_s = row.timeout_s;
    }
    valid.push_back(std::move(row));
  }
  summary.valid = static_cast<int>(valid.size());
  summary.times = summarize(valid);
  summary.total_times = summarize(valid, &BenchmarkRow::total_time_s);
  summary.path_length_mean = lengths / std::max(1, summary.times.solved);
  summary.duration_mean_s = durations_s / std::max(1, summary.times.solved);
  summary.iterations_p50 = median(std::move(iterations));
  summary.states_p50 = median(std::move(states));
  summary.simplification_p50_s = median(std::move(simplification));
  return summary;
}

void append_summaries(std::span<const BenchmarkRow> rows, bool is_together,
                      std::vector<SetSummary>& summaries) {
  const auto set_of = [&](const BenchmarkRow& row) {
    return is_together ? std::string("all") : row.set;
  };
  for (const Rows& same : grouped(rows, [&](const BenchmarkRow& row) {
         return std::tuple(set_of(row), row.planner, row.sampler, row.setting);
       })) {
    summaries.push_back(summarize_set(set_of(same.front()), same));
  }
}

}  // namespace

std::string text_table(const std::vector<std::vector<std::string>>& lines,
                       std::size_t name_columns) {
  std::vector<int> widths;
  for (const auto& cells : lines) {
    widths.resize(std::max(widths.size(), cells.size()));
    for (std::size_t i = 0; i < cells.size(); ++i) {
      widths[i] = std::max(widths[i], character_count(cells[i]));
    }
  }
  std::string text;
  for (const auto& cells : lines) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::string padding(static_cast<std::size_t>(widths[i] - character_count(cells[i])),
                                ' ');
      text += i < name_columns ? cells[i] + padding : padding + cells[i];
      if (i + 1 < cells.size()) text += "  ";
    }
    text += '\n';
  }
  return text;
}

std::vector<RunGroup> group_runs(std::span<const BenchmarkRow> rows) {
  std::vector<RunGroup> groups;
  for (const Rows& same : grouped(rows, [](const BenchmarkRow& row) {
         return std::tuple(row.problem, row.planner, row.sampler);
       })) {
    const auto valid = std::ranges::count(same, true, &BenchmarkRow::is_path_valid);
    groups.push_back({same[0].problem, same[0].planner, same[0].sampler, summarize(same),
                      static_cast<int>(valid)});
  }
  return groups;
}

int nearest_rank(int percent, int count) { return std::max(1, (percent * count + 99) / 100); }

bool is_censored(const TimeSummary& times, int percent) {
  return nearest_rank(percent, times.runs) > times.solved;
}

std::string format_ms(double seconds) {
  const double ms = seconds * 1e3;
  if (ms >= 100) return fmt::format("{:.0f}", ms);
  if (ms >= 10) return fmt::format("{:.1f}", ms);
  return fmt::format("{:.2f}", ms);
}

std::string format_percentile(const TimeSummary& times, int percent) {
  const double seconds = percent == 50   ? times.p50
                         : percent == 95 ? times.p95
                         : percent == 99 ? times.p99
                                         : times.max;
  return fmt::format("{}{}", is_censored(times, percent) ? ">" : "", format_ms(seconds));
}

}  // namespace mneme::internal

namespace mneme {
namespace {

std::vector<std::string> table_cells(const internal::RunGroup& group) {
  const TimeSummary& times = group.times;
  return {internal::single_line(group.problem),
          internal::single_line(group.planner),
          internal::single_line(group.sampler),
          fmt::format("{}/{}", times.solved, times.runs),
          std::to_string(group.valid),
          internal::format_percentile(times, 50),
          internal::format_percentile(times, 95),
          internal::format_percentile(times, 99),
          internal::format_percentile(times, 100)};
}

/// With failures at their limit it is a bound.
std::string format_mean(const TimeSummary& times) {
  return (times.solved < times.runs ? ">" : "") + internal::format_ms(times.mean);
}

std::vector<std::string> cells(const SetSummary& s) {
  return {internal::single_line(s.set),
          internal::single_line(s.planner),
          internal::single_line(s.sampler),
          fmt::format("{}/{}/{}", s.times.solved, s.valid, s.total),
          std::to_string(s.invalid_paths),
          internal::format_percentile(s.times, 50),
          format_mean(s.times),
          internal::format_percentile(s.times, 95),
          internal::format_percentile(s.times, 99),
          internal::format_percentile(s.times, 100),
          internal::format_percentile(s.total_times, 50),
          internal::format_percentile(s.total_times, 99),
          internal::format_percentile(s.total_times, 100),
          std::to_string(s.iterations_p50),
          std::to_string(s.states_p50),
          fmt::format("{:.2f}", s.path_length_mean),
          fmt::format("{:.2f}", s.duration_mean_s)};
}

}  // namespace

TimeSummary summarize(std::span<const BenchmarkRow> rows, double BenchmarkRow::*time_s) {
  TimeSummary summary;
  if (rows.empty()) return summary;
  std::vector<std::pair<bool, double>> times;  // failures sort after all successes
  for (const BenchmarkRow& row : rows) times.emplace_back(!row.is_solved, row.*time_s);
  std::ranges::sort(times);
  summary.runs = static_cast<int>(rows.size());
  summary.solved = static_cast<int>(std::ranges::count(rows, true, &BenchmarkRow::is_solved));
  const auto percentile = [&](int percent) {
    return times[static_cast<std::size_t>(internal::nearest_rank(percent, summary.runs) - 1)]
        .second;
  };
  for (const BenchmarkRow& row : rows) summary.mean += row.*time_s / summary.runs;
  summary.p25 = percentile(25);
  summary.p50 = percentile(50);
  summary.p75 = percentile(75);
  summary.p95 = percentile(95);
  summary.p99 = percentile(99);
  summary.max = percentile(100);
  return summary;
}

std::string to_table(std::span<const BenchmarkRow> rows) {
  constexpr std::size_t kNameColumns = 3;
  std::vector<std::vector<std::string>> lines = {
      {"problem", "planner", "sampler", "solved", "valid", "p50 ms", "p95 ms", "p99 ms", "max ms"}};
  for (const internal::RunGroup& group : internal::group_runs(rows)) {
    lines.push_back(table_cells(group));
  }
  return internal::text_table(lines, kNameColumns);
}

bool is_invalid_problem(const BenchmarkRow& row) {
  return row.status == PlanStatus::invalid_start || row.status == PlanStatus::invalid_goal;
}

bool is_success(const BenchmarkRow& row) { return row.is_solved && row.is_path_valid; }

std::vector<SetSummary> summarize_sets(std::span<const BenchmarkRow> rows) {
  std::vector<SetSummary> summaries;
  internal::append_summaries(rows, false, summaries);
  if (internal::different(rows, &BenchmarkRow::set).size() > 1) {
    internal::append_summaries(rows, true, summaries);
  }
  return summaries;
}

std::string to_table(std::span<const SetSummary> summaries) {
  constexpr std::size_t kNameColumns = 3;
  std::vector<std::vector<std::string>> lines = {
      {"set", "planner", "sampler", "solved/valid/total", "bad paths", "p50 ms", "mean ms",
       "p95 ms", "p99 ms", "max ms", "total p50 ms", "total p99 ms", "total max ms",
       "iterations p50", "states p50", "mean length", "mean duration s"}};
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
