// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "bench_results.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "console.h"
#include "live_table.h"

namespace mneme::app {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const SetSummary& summary) {
  return {{"set", summary.set},
          {"planner", summary.planner},
          {"sampler", summary.sampler},
          {"setting", summary.setting},
          {"solved", summary.times.solved},
          {"valid", summary.valid},
          {"total", summary.total},
          {"invalid_paths", summary.invalid_paths},
          {"planning_p50_s", summary.times.p50},
          {"planning_p95_s", summary.times.p95},
          {"planning_p99_s", summary.times.p99},
          {"planning_max_s", summary.times.max},
          {"iterations_p50", summary.iterations_p50},
          {"simplification_p50_s", summary.simplification_p50_s}};
}

/// "cage#7" once for each problem whose ends are invalid.
std::vector<std::string> invalid_problems(const std::vector<BenchmarkRow>& rows) {
  std::vector<std::string> names;
  for (const BenchmarkRow& row : rows) {
    const std::string name = row.set + "#" + row.problem;
    const bool is_new = std::find(names.begin(), names.end(), name) == names.end();
    if (is_invalid_problem(row) && is_new) names.push_back(name);
  }
  return names;
}

}  // namespace

void print_bench_results(const std::vector<BenchmarkRow>& rows, bool is_json) {
  const std::vector<SetSummary> summaries = summarize_sets(rows);
  const std::vector<std::string> invalid = invalid_problems(rows);
  if (!is_json) {
    fmt::print("{}", printable_table(summaries));
    if (!invalid.empty()) {
      fmt::print("invalid start or goal, left out: {}\n",
                 printable(fmt::format("{}", fmt::join(invalid, ", "))));
    }
    return;
  }
  Json sets = Json::array();
  for (const SetSummary& summary : summaries) sets.push_back(to_json(summary));
  print_json({{"runs", rows.size()},
              {"isa", to_string(default_isa())},
              {"sets", sets},
              {"invalid", invalid}});
}

ExitCode judge_rows(const std::vector<BenchmarkRow>& rows) {
  const auto wrong = std::count_if(rows.begin(), rows.end(), [](const BenchmarkRow& row) {
    return row.is_solved && !row.is_path_valid;
  });
  if (wrong == 0) return ExitCode::done;
  print_error(fmt::format("{} did not survive the check at ten times the resolution",
                          counted(static_cast<std::size_t>(wrong), "path", "paths")));
  return ExitCode::failure;
}

Result<bool> run_with_progress(BenchPlan& plan, RowFile& file) {
  const Result<void> same = check_same_settings(plan, file.rows());
  if (!same) return tl::unexpected(same.error());
  LiveTable table(plan.run_count());
  const std::vector<BenchmarkRow> done = file.rows();
  const auto is_complete = run_bench(plan, done, [&](const BenchmarkRow& row) {
    return file.add(row).map([&] { table.update(file.rows()); });
  });
  if (!is_complete) return is_complete;
  std::vector<BenchmarkRow> rows = file.rows();
  sort_rows(plan, rows);
  return file.replace(std::move(rows)).map([&] { return *is_complete; });
}

}  // namespace mneme::app
