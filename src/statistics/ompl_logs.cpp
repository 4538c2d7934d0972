// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/report.h"
#include "mneme/statistics.h"

#include "statistics/panels.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <unistd.h>
#include <algorithm>
#include <array>
#include <sstream>

namespace mneme {
namespace {

/// Values of ompl::base::PlannerStatus, and their names in order.
enum OmplStatus { invalid_start = 1, invalid_goal = 2, timeout = 4, exact_solution = 6, abort = 8 };
constexpr std::string_view kOmplStatuses =
    "Unknown status|Invalid start|Invalid goal|Unrecognized goal type|Timeout|Approximate solution|"
    "Exact solution|Crash|Abort";

std::string is_solved(const BenchmarkRow& row) { return is_success(row) ? "1" : "0"; }
std::string solution_time(const BenchmarkRow& row) {
  return fmt::format("{}", is_success(row) ? row.planning_time_s : row.timeout_s);
}
std::string solution_length(const BenchmarkRow& row) {
  return is_success(row) ? fmt::format("{}", row.path_length) : "";
}
std::string ompl_status(const BenchmarkRow& row) {
  OmplStatus status = is_success(row) ? exact_solution : timeout;
  if (row.status == PlanStatus::invalid_start) status = invalid_start;
  if (row.status == PlanStatus::invalid_goal) status = invalid_goal;
  if (row.status == PlanStatus::cancelled) status = abort;
  return fmt::format("{}", static_cast<int>(status));
}
template <auto kMember>
std::string value_of(const BenchmarkRow& row) {
  return fmt::format("{}", row.*kMember);
}

struct OmplProperty {
  std::string_view name;  ///< with its SQL type
  std::string (*value)(const BenchmarkRow& row);
};
constexpr std::array<OmplProperty, 16> kProperties = {
    {{"solved BOOLEAN", is_solved},
     {"correct solution BOOLEAN", is_solved},
     {"time REAL", solution_time},
     {"simplification time REAL", value_of<&BenchmarkRow::simplification_time_s>},
     {"solution length REAL", solution_length},
     {"status ENUM", ompl_status},
     {"seed INTEGER", value_of<&BenchmarkRow::seed>},
     {"iterations INTEGER", value_of<&BenchmarkRow::iterations>},
     {"graph states INTEGER", value_of<&BenchmarkRow::nodes>},
     {"states checked INTEGER", value_of<&BenchmarkRow::states_checked>},
     {"motions checked INTEGER", value_of<&BenchmarkRow::motions_checked>},
     {"total time REAL", value_of<&BenchmarkRow::total_time_s>},
     {"retrieval time REAL", value_of<&BenchmarkRow::retrieval_time_s>},
     {"learning time REAL", value_of<&BenchmarkRow::learning_time_s>},
     {"verification time REAL", value_of<&BenchmarkRow::verification_time_s>},
     {"components INTEGER", value_of<&BenchmarkRow::components>}}};

/// The runs of one planner with one sampler and setting.
struct OmplPlannerLog {
  std::string name;
  std::vector<const BenchmarkRow*> runs;
};
/// The runs on one problem.
struct OmplExperiment {
  std::string name;
  std::vector<OmplPlannerLog> planners;
};

/// The entry of that name; added if missing.
template <class Entry>
Entry& entry_of(const std::string& name, std::vector<Entry>& all) {
  const auto found = std::ranges::find(all, name, &Entry::name);
  return found != all.end() ? *found : all.emplace_back(Entry{name, {}});
}

std::vector<OmplExperiment> to_experiments(std::span<const BenchmarkRow> rows) {
  std::vector<OmplExperiment> experiments;
  for (const BenchmarkRow& row : rows) {
    const bool is_named = row.set.empty() || row.set == row.problem;
    OmplExperiment& experiment = entry_of(
        internal::file_name(is_named ? row.problem : row.set + "_" + row.problem), experiments);
    std::string name = row.planner + "_" + row.sampler;
    if (!row.setting.empty()) name += "_" + row.setting;
    entry_of(internal::file_name(name), experiment.planners).runs.push_back(&row);
  }
  return experiments;
}

/// Lines "range = 3" of the text "range=3 sigma=0.1", after sampler and time limit.
std::vector<std::string> setting_lines(const BenchmarkRow& row) {
  std::vector<std::string> lines = {"sampler = " + row.sampler,
                                    fmt::format("timeout = {}", row.timeout_s)};
  std::istringstream words(row.settings);
  for (std::string word; words >> word;) {
    const std::size_t sign = word.find('=');
    if (sign == std::string::npos) continue;
    lines.push_back(word.replace(sign, 1, " = "));
  }
  return lines;
}

std::string section(const OmplPlannerLog& planner) {
  const std::vector<std::string> settings = setting_lines(*planner.runs.front());
  std::string text = fmt::format("{}\n{} common properties\n{}\n", planner.name, settings.size(),
                                 fmt::join(settings, "\n"));
  text += fmt::format("{} properties for each run\n", kProperties.size());
  for (const OmplProperty& property : kProperties) text += fmt::format("{}\n", property.name);
  text += fmt::format("{} runs\n", planner.runs.size());
  for (const BenchmarkRow* run : planner.runs) {
    for (const OmplProperty& property : kProperties) {
      text += fmt::format("{}; ", property.value(*run));
    }
    text += "\n";
  }
  return text + ".\n";
}

std::string host_name() {
  char name[256] = "unknown";
  gethostname(name, sizeof name - 1);
  return internal::file_name(name);
}

/// "2026-01-31T12:00:00Z" as "2026-01-31 12:00:00".
std::string plain_date(std::string date) {
  if (date.empty()) return "1970-01-01 00:00:00";
  std::ranges::replace(date, 'T', ' ');
  std::erase(date, 'Z');
  return date;
}

std::string head(const OmplExperiment& experiment) {
  double timeout_s = 0, total_time_s = 0;
  std::size_t run_count = 0;
  for (const OmplPlannerLog& planner : experiment.planners) {
    run_count = std::max(run_count, planner.runs.size());
    for (const BenchmarkRow* run : planner.runs) {
      timeout_s = std::max(timeout_s, run->timeout_s);
      total_time_s += run->total_time_s;
    }
  }
  const BenchmarkRow& first = *experiment.planners.front().runs.front();
  return fmt::format(
      "mneme version {}\nExperiment {}\nRunning on {}\nStarting at {}\n"
      "<<<|\nset {}, problem {}\n|>>>\n<<<|\n{}\n|>>>\n{} is the random seed\n{} seconds per run\n"
      "0 MB per run\n{} runs per planner\n{} seconds spent to collect the data\n1 enum type\n"
      "status|{}\n{} planners\n",
      version(), experiment.name, host_name(), plain_date(first.started),
      internal::file_name(first.set), internal::file_name(first.problem),
      first.machine.empty() ? "not recorded" : first.machine, first.seed, timeout_s, run_count,
      total_time_s, kOmplStatuses, experiment.planners.size());
}

}  // namespace

std::vector<OmplLog> to_ompl_logs(std::span<const BenchmarkRow> rows) {
  std::vector<OmplLog> logs;
  for (const OmplExperiment& experiment : to_experiments(rows)) {
    std::string text = head(experiment);
    for (const OmplPlannerLog& planner : experiment.planners) text += section(planner);
    logs.push_back({experiment.name, std::move(text)});
  }
  return logs;
}

Result<void> write_ompl_logs(const std::string& directory, std::span<const BenchmarkRow> rows) {
  MNEME_TRY(make_directory(directory));
  for (const OmplLog& log : to_ompl_logs(rows)) {
    MNEME_TRY(write_file(fmt::format("{}/{}.log", directory, log.experiment), log.text));
  }
  return {};
}

}  // namespace mneme
