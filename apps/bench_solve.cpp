// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "bench_solve.h"

#ifdef MNEME_WITH_OMPL
#include "mneme/ompl.h"
#endif

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace mneme::app {
namespace {

constexpr std::string_view kOmplPrefix = "ompl:";

#ifdef MNEME_WITH_OMPL

void append_ompl_names(SuiteNames& names) {
  for (const std::string_view name : ompl_planner_names()) {
    names.planners.push_back(std::string(kOmplPrefix) + std::string(name));
  }
  for (const std::string_view name : ompl_sampler_names()) names.samplers.emplace_back(name);
}

Result<SolveResult> solve_ompl(const Problem& problem, Database* database,
                               const SolveSettings& settings, bool is_as_in_paper,
                               const std::string& experience) {
  OmplSettings ompl;
  ompl.as_in_paper = is_as_in_paper;
  ompl.experience_path = experience;
  return solve_with_ompl(problem, database, settings, ompl);
}

#else

// The names that the suites of bench/suites use, so that they can be read.
void append_ompl_names(SuiteNames& names) {
  for (const char* name : {"RRT", "RRTConnect", "PRM", "BKPIECE1", "KPIECE1", "BiEST", "STRIDE",
                           "SBL", "BITstar", "Lightning", "Thunder"}) {
    names.planners.push_back(std::string(kOmplPrefix) + name);
  }
  for (const char* name : {"gaussian", "obstacle_based", "bridge_test", "max_clearance"}) {
    names.samplers.emplace_back(name);
  }
}

Result<SolveResult> solve_ompl(const Problem&, Database*, const SolveSettings& settings, bool,
                               const std::string&) {
  return fail(ErrorCode::unsupported, settings.planner + ": this mneme was built without OMPL");
}

#endif

}  // namespace

SuiteNames bench_names() {
  SuiteNames names;
  for (const PlannerEntry& planner : planners()) names.planners.emplace_back(planner.name);
  for (const std::string_view sampler : sampler_names()) names.samplers.emplace_back(sampler);
  append_ompl_names(names);
  return names;
}

bool is_ompl_planner(std::string_view planner) { return planner.starts_with(kOmplPrefix); }

bool is_experience_planner(std::string_view planner) {
  return planner == "ompl:Lightning" || planner == "ompl:Thunder";
}

Result<void> train_experience(std::string_view planner, const Robot& robot,
                              std::span<const Path> paths, const std::string& file) {
#ifdef MNEME_WITH_OMPL
  return train_ompl_experience(planner.substr(kOmplPrefix.size()), robot, paths, file);
#else
  static_cast<void>(robot);
  static_cast<void>(paths);
  return fail(ErrorCode::unsupported,
              fmt::format("'{}': {} needs a mneme that was built with OMPL", file, planner));
#endif
}

bool is_missing_planner(const std::string& planner) {
#ifdef MNEME_WITH_OMPL
  static_cast<void>(planner);
  return false;
#else
  return is_ompl_planner(planner);
#endif
}

Result<void> check_names(const SolveSettings& settings) {
  SuiteNames names = bench_names();
  std::erase_if(names.planners, is_missing_planner);
  const auto has = [](const auto& all, std::string_view name) {
    return std::find(all.begin(), all.end(), name) != all.end();
  };
  if (!is_ompl_planner(settings.planner) && !has(names.planners, settings.planner)) {
    return fail(ErrorCode::invalid, fmt::format("unknown planner '{}': expected one of {}",
                                                settings.planner, fmt::join(names.planners, ", ")));
  }
  if (!has(names.samplers, settings.sampler)) {
    return fail(ErrorCode::invalid, fmt::format("unknown sampler '{}': expected one of {}",
                                                settings.sampler, fmt::join(names.samplers, ", ")));
  }
  if (is_ompl_planner(settings.planner) || has(sampler_names(), settings.sampler)) return {};
  return fail(ErrorCode::invalid,
              fmt::format("sampler '{}' is OMPL's: expected a planner of OMPL that draws valid "
                          "states, such as ompl:PRM, not '{}'",
                          settings.sampler, settings.planner));
}

Result<SolveResult> solve_with_any(const Problem& problem, Database* database,
                                   const SolveSettings& settings, bool is_ompl_as_in_paper,
                                   const std::string& ompl_experience) {
  if (auto checked = check_names(settings); !checked) return tl::unexpected(checked.error());
  if (!is_ompl_planner(settings.planner)) return solve(problem, database, settings);
  return solve_ompl(problem, database, settings, is_ompl_as_in_paper, ompl_experience);
}

}  // namespace mneme::app
