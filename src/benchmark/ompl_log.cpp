// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmark/ompl_experiment.h"
#include "mneme/benchmark.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

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
