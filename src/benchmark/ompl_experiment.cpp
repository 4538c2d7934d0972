// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmark/ompl_experiment.h"

#include "mneme/benchmark.h"

#include "benchmark/panels.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <unistd.h>
#include <algorithm>
#include <sstream>

namespace mneme::internal {
namespace {

int ompl_status(const BenchmarkRow& row) {
  switch (row.status) {
    case PlanStatus::invalid_start:
      return 1;
    case PlanStatus::invalid_goal:
      return 2;
    case PlanStatus::cancelled:
      return 8;
    case PlanStatus::solved:
      return is_success(row) ? 6 : 4;
    default:
      return 4;
  }
}

std::vector<std::string> property_values(const BenchmarkRow& row) {
  const auto text = [](auto value) { return fmt::format("{}", value); };
  const double time_s = is_success(row) ? row.planning_time_s : row.timeout_s;
  return {text(int(is_success(row))),
          text(int(is_success(row))),
          text(time_s),
          text(row.simplification_time_s),
          is_success(row) ? text(row.path_length) : "",
          text(ompl_status(row)),
          text(row.seed),
          text(row.iterations),
          text(row.nodes),
          text(row.states_checked),
          text(row.motions_checked),
          text(row.total_time_s),
          text(row.retrieval_time_s),
          text(row.learning_time_s),
          text(row.verification_time_s),
          text(row.components)};
}

std::string planner_name(const BenchmarkRow& row) {
  std::string name = row.planner + "_" + row.sampler;
  if (!row.setting.empty()) name += "_" + row.setting;
  return file_name(name);
}

/// "range=3 sigma=0.1" as lines.
std::vector<std::string> setting_lines(const BenchmarkRow& row) {
  std::vector<std::string> lines = {"sampler = " + row.sampler,
                                    fmt::format("timeout = {}", row.timeout_s)};
  std::istringstream words(row.settings);
  for (std::string word; words >> word;) {
    const std::size_t sign = word.find('=');
    if (sign == std::string::npos) continue;
    lines.push_back(word.substr(0, sign) + " = " + word.substr(sign + 1));
  }
  return lines;
}

std::string host_name() {
  char name[256] = "unknown";
  gethostname(name, sizeof name - 1);
  return file_name(name);
}

/// "2026-01-31T12:00:00Z" as "2026-01-31 12:00:00".
std::string plain_date(const BenchmarkRow& row) {
  if (row.started.empty()) return "1970-01-01 00:00:00";
  std::string date = row.started;
  std::ranges::replace(date, 'T', ' ');
  std::erase(date, 'Z');
  return date;
}

OmplExperiment& experiment_of(const BenchmarkRow& row, std::vector<OmplExperiment>& all) {
  const std::string name = file_name(
      row.set.empty() || row.set == row.problem ? row.problem : row.set + "_" + row.problem);
  const auto found = std::ranges::find(all, name, &OmplExperiment::name);
  if (found != all.end()) return *found;
  OmplExperiment& added = all.emplace_back();
  added.name = name;
  added.host = host_name();
  added.machine = row.machine.empty() ? "not recorded" : row.machine;
  added.date = plain_date(row);
  added.setup = fmt::format("set {}, problem {}", file_name(row.set), file_name(row.problem));
  added.seed = fmt::format("{}", row.seed);
  return added;
}

}  // namespace

std::vector<OmplExperiment> to_experiments(std::span<const BenchmarkRow> rows) {
  std::vector<OmplExperiment> experiments;
  for (const BenchmarkRow& row : rows) {
    OmplExperiment& experiment = experiment_of(row, experiments);
    experiment.timeout_s = std::max(experiment.timeout_s, row.timeout_s);
    experiment.total_time_s += row.total_time_s;
    const std::string name = planner_name(row);
    auto planner = std::ranges::find(experiment.planners, name, &OmplPlanner::name);
    if (planner == experiment.planners.end()) {
      experiment.planners.push_back({name, setting_lines(row), {}});
      planner = experiment.planners.end() - 1;
    }
    planner->runs.push_back(property_values(row));
    experiment.run_count = std::max(experiment.run_count, planner->runs.size());
  }
  return experiments;
}

}  // namespace mneme::internal

namespace mneme {
namespace {

using internal::kOmplProperties;
using internal::OmplExperiment;
using internal::OmplPlanner;

std::string head(const OmplExperiment& experiment) {
  return fmt::format(
      "mneme version {}\nExperiment {}\nRunning on {}\nStarting at {}\n<<<|\n{}\n|>>>\n<<<|\n{}\n"
      "|>>>\n{} is the random seed\n{} seconds per run\n0 MB per run\n{} runs per planner\n{} "
      "seconds spent to collect the data\n1 enum type\nstatus|{}\n{} planners\n",
      version(), experiment.name, experiment.host, experiment.date, experiment.setup,
      experiment.machine, experiment.seed, experiment.timeout_s, experiment.run_count,
      experiment.total_time_s, fmt::join(internal::kOmplStatuses, "|"), experiment.planners.size());
}

std::string section(const OmplPlanner& planner) {
  std::string text =
      fmt::format("{}\n{} common properties\n", planner.name, planner.settings.size());
  for (const std::string& line : planner.settings) text += line + "\n";
  text += fmt::format("{} properties for each run\n", kOmplProperties.size());
  for (const auto& [name, type] : kOmplProperties) text += fmt::format("{} {}\n", name, type);
  text += fmt::format("{} runs\n", planner.runs.size());
  for (const auto& run : planner.runs) text += fmt::format("{}; \n", fmt::join(run, "; "));
  return text + ".\n";
}

}  // namespace

std::vector<OmplLog> to_ompl_logs(std::span<const BenchmarkRow> rows) {
  std::vector<OmplLog> logs;
  for (const OmplExperiment& experiment : internal::to_experiments(rows)) {
    std::string text = head(experiment);
    for (const OmplPlanner& planner : experiment.planners) text += section(planner);
    logs.push_back({experiment.name, std::move(text)});
  }
  return logs;
}

}  // namespace mneme
