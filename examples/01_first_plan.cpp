// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Plans a problem that came with mneme, or the one whose file is given.
#include "mneme/mneme.h"

#include <cstdio>

namespace {

int fail_with(const mneme::Error& error) {
  std::fprintf(stderr, "%s\n", error.message.c_str());
  return 1;
}

}  // namespace

int main(int argument_count, char** arguments) {
  const auto file = argument_count > 1 ? mneme::Result<std::string>(arguments[1])
                                       : mneme::find_scene("planar/scenario2.yaml");
  if (!file) return fail_with(file.error());
  const auto problem = mneme::load_problem(*file);
  if (!problem) return fail_with(problem.error());

  mneme::SolveSettings settings;
  settings.sampler = "uniform";  // there is no memory yet
  settings.plan.seed = 1;
  const auto result = mneme::solve(*problem, nullptr, settings);
  if (!result) return fail_with(result.error());
  if (!result->plan.is_solved()) return std::puts(result->plan.message.c_str()), 3;

  std::printf("%s: %zu configurations, %.2f ms\n", problem->name.c_str(), result->plan.path.size(),
              1e3 * result->planning_time_s);
  for (const mneme::Configuration& q : result->plan.path) {
    for (const double value : q) std::printf("%9.5f", value);
    std::printf("\n");
  }
  return 0;
}
