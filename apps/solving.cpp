// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "solving.h"

#ifdef MNEME_WITH_OMPL
#include "mneme/ompl.h"
#endif

namespace mneme::app {

std::vector<std::string> planner_names() {
  std::vector<std::string> names;
  for (const PlannerEntry& planner : planners()) names.emplace_back(planner.name);
#ifdef MNEME_WITH_OMPL
  for (const std::string_view name : ompl_planner_names()) {
    names.push_back("ompl:" + std::string(name));
  }
#endif
  return names;
}

std::vector<std::string> all_sampler_names() {
  std::vector<std::string> names(sampler_names().begin(), sampler_names().end());
#ifdef MNEME_WITH_OMPL
  names.insert(names.end(), ompl_sampler_names().begin(), ompl_sampler_names().end());
#endif
  return names;
}

Result<SolveResult> solve_by_name(const Problem& problem, Database* database,
                                  const SolveSettings& settings,
                                  [[maybe_unused]] bool as_in_paper) {
#ifdef MNEME_WITH_OMPL
  if (settings.planner.starts_with("ompl:")) {
    OmplSettings ompl;
    ompl.as_in_paper = as_in_paper;
    return solve_with_ompl(problem, database, settings, ompl);
  }
#endif
  return solve(problem, database, settings);
}

}  // namespace mneme::app
