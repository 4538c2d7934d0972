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

bool is_ompl_planner(std::string_view planner) { return planner.starts_with(kOmplPrefix); }

#ifdef MNEME_WITH_OMPL

constexpr bool kHasOmpl = true;

std::vector<std::string> ompl_planners() {
  return {ompl_planner_names().begin(), ompl_planner_names().end()};
}

std::vector<std::string> ompl_samplers() {
  return {ompl_sampler_names().begin(), ompl_sampler_names().end()};
}

Result<SolveResult> solve_ompl(const Problem& problem, Database* database,
                               const BenchCase& bench_case) {
  OmplSettings ompl;
  ompl.as_in_paper = bench_case.is_ompl_as_in_paper;
  ompl.experience_path = bench_case.own_experience;
  return solve_with_ompl(problem, database, bench_case.settings, ompl);
}

#else

constexpr bool kHasOmpl = false;

// The names that the suites of bench/suites use, so that they can be read.
std::vector<std::string> ompl_planners() {
  return {"RRT",    "RRTConnect", "PRM",     "BKPIECE1",  "KPIECE1", "BiEST",
          "STRIDE", "SBL",        "BITstar", "Lightning", "Thunder"};
}

std::vector<std::string> ompl_samplers() {
  return {"gaussian", "obstacle_based", "bridge_test", "max_clearance"};
}

Result<SolveResult> solve_ompl(const Problem&, Database*, const BenchCase& bench_case) {
  return fail(ErrorCode::unsupported,
              bench_case.settings.planner + ": this mneme was built without OMPL");
}

#endif

}  // namespace

std::vector<BenchPlanner> bench_planners() {
  std::vector<BenchPlanner> all;
  for (const PlannerEntry& planner : planners()) all.push_back({std::string(planner.name)});
  for (const std::string& name : ompl_planners()) {
    const bool has_own_experience = name == "Lightning" || name == "Thunder";
    all.push_back({std::string(kOmplPrefix) + name, kHasOmpl, true, has_own_experience});
  }
  return all;
}

SuiteNames bench_names() {
  SuiteNames names;
  for (const BenchPlanner& planner : bench_planners()) names.planners.push_back(planner.name);
  names.samplers = {sampler_names().begin(), sampler_names().end()};
  for (const std::string& name : ompl_samplers()) names.samplers.push_back(name);
  return names;
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

Result<void> check_names(const SolveSettings& settings) {
  SuiteNames names = bench_names();
  if (!kHasOmpl) std::erase_if(names.planners, is_ompl_planner);
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

Result<SolveResult> solve_case(const Problem& problem, Database* database,
                               const BenchCase& bench_case) {
  const SolveSettings& settings = bench_case.settings;
  if (auto checked = check_names(settings); !checked) return tl::unexpected(checked.error());
  if (!is_ompl_planner(settings.planner)) return solve(problem, database, settings);
  return solve_ompl(problem, database, bench_case);
}

}  // namespace mneme::app
