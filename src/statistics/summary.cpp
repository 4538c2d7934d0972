// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/statistics.h"

#include "statistics/panels.h"
#include "statistics/tables.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

namespace mneme::internal {
namespace {

using Rows = std::vector<BenchmarkRow>;

template <class T>
T median(std::vector<T> values) {
  if (values.empty()) return {};
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(nearest_rank(50, static_cast<int>(values.size())) - 1)];
}

SetSummary summarize_set(const Rows& rows) {
  SetSummary summary;
  summary.set = rows.front().set;
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

}  // namespace

std::vector<SetSummary> summarize_each(std::span<const BenchmarkRow> rows) {
  std::map<std::tuple<std::string, std::string, std::string, std::string>, std::size_t> positions;
  std::vector<Rows> groups;
  for (const BenchmarkRow& row : rows) {
    const auto [position, is_new] =
        positions.try_emplace({row.set, row.planner, row.sampler, row.setting}, groups.size());
    if (is_new) groups.emplace_back();
    groups[position->second].push_back(row);
  }
  std::vector<SetSummary> summaries;
  for (const Rows& group : groups) summaries.push_back(summarize_set(group));
  return summaries;
}

}  // namespace mneme::internal

namespace mneme {

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
  summary.p50 = percentile(50);
  summary.p95 = percentile(95);
  summary.p99 = percentile(99);
  summary.max = percentile(100);
  return summary;
}

bool is_invalid_problem(const BenchmarkRow& row) {
  return row.status == PlanStatus::invalid_start || row.status == PlanStatus::invalid_goal;
}

bool is_success(const BenchmarkRow& row) { return row.is_solved && row.is_path_valid; }

std::string_view describe_timing(std::span<const BenchmarkRow> rows) {
  const auto warm = std::ranges::count(rows, true, &BenchmarkRow::is_warm);
  return warm == 0 ? "cold" : warm == std::ssize(rows) ? "warm" : "mixed";
}

std::vector<SetSummary> summarize_sets(std::span<const BenchmarkRow> rows) {
  std::vector<SetSummary> summaries = internal::summarize_each(rows);
  if (internal::different(rows, &BenchmarkRow::set).size() <= 1) return summaries;
  std::vector<BenchmarkRow> all(rows.begin(), rows.end());
  for (BenchmarkRow& row : all) row.set = "all";
  std::ranges::move(internal::summarize_each(all), std::back_inserter(summaries));
  return summaries;
}

}  // namespace mneme
