// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/report.h"

#include "report/markup.h"
#include "report/summary.h"
#include "report/text_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

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

}  // namespace

namespace internal {

std::vector<RunGroup> group_runs(std::span<const BenchmarkRow> rows) {
  using Name = std::tuple<std::string, std::string, std::string>;
  std::map<Name, std::size_t> positions;
  std::vector<std::vector<BenchmarkRow>> runs;
  for (const BenchmarkRow& row : rows) {
    const Name name{row.problem, row.planner, row.sampler};
    const std::size_t position = positions.try_emplace(name, runs.size()).first->second;
    if (position == runs.size()) runs.emplace_back();
    runs[position].push_back(row);
  }
  std::vector<RunGroup> groups;
  for (const auto& same : runs) {
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

}  // namespace internal

TimeSummary summarize(std::span<const BenchmarkRow> rows) {
  TimeSummary summary;
  if (rows.empty()) return summary;
  std::vector<std::pair<bool, double>> times;  // failures sort after all successes
  for (const BenchmarkRow& row : rows) times.emplace_back(!row.is_solved, row.planning_time_s);
  std::ranges::sort(times);
  summary.runs = static_cast<int>(rows.size());
  summary.solved = static_cast<int>(std::ranges::count(rows, true, &BenchmarkRow::is_solved));
  const auto percentile = [&](int percent) {
    return times[static_cast<std::size_t>(internal::nearest_rank(percent, summary.runs) - 1)]
        .second;
  };
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

}  // namespace mneme
