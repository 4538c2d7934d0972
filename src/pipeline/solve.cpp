// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// decompose the scene -> retrieve (or learn) a local sampler per primitive -> synthesize one
// sampler -> plan
#include <algorithm>
#include <array>

#include "base/stopwatch.h"
#include "mneme/pipeline.h"
#include "pipeline/check_settings.h"
#include "pipeline/complete_settings.h"
#include "pipeline/database_check.h"
#include "pipeline/make_checker.h"
#include "pipeline/recall.h"
#include "pipeline/remember.h"

namespace mneme {
namespace {

constexpr std::array<std::string_view, 6> kSamplerNames = {"gl",     "uniform",        "halton",
                                                           "pooled", "nearest_scenes", "cvae"};

Result<const PlannerEntry*> choose_planner(const std::string& name) {
  if (const PlannerEntry* planner = find_planner(name)) return planner;
  std::vector<std::string_view> names;
  for (const PlannerEntry& planner : planners()) names.push_back(planner.name);
  return fail(ErrorCode::invalid,
              "unknown planner '" + name + "': expected one of " + internal::join(names));
}

/// The planner with memory: its time and that of retrieval are one.
Result<void> plan_with_memory(const Problem& problem, Database& database,
                              const CollisionChecker& checker, Planner plan,
                              const SolveSettings& settings, double spent_s, SolveResult& result) {
  if (auto checked = internal::check_database(problem.robot, settings, database); !checked) {
    return checked;
  }
  const internal::Stopwatch stopwatch;
  internal::Recall recall(problem, database, checker, settings);
  const std::shared_ptr<const Sampler> sampler = recall.make_sampler();
  const double recall_time_s = stopwatch.elapsed_s();
  if (recall.failure()) return tl::unexpected(*recall.failure());
  PlanSettings rest = settings.plan;
  rest.timeout_s = std::max(0.0, rest.timeout_s - spent_s - recall_time_s);
  result.plan = plan(checker, {problem.start, problem.goals}, *sampler, rest);
  result.plan.planning_time_s += recall_time_s;
  if (recall.failure()) return tl::unexpected(*recall.failure());
  result.gl = recall.take();
  return {};
}

}  // namespace

std::span<const std::string_view> sampler_names() { return kSamplerNames; }

Result<SolveResult> solve(const Problem& problem, Database* database,
                          const SolveSettings& settings) {
  const internal::Stopwatch stopwatch;
  for (const auto& checked :
       {internal::check_sampler(settings, kSamplerNames), internal::check_ranges(settings),
        internal::check_verification(settings.plan)}) {
    if (!checked) return tl::unexpected(checked.error());
  }
  const SolveSettings complete = internal::complete_settings(settings, problem.robot, database);
  const auto planner = choose_planner(settings.planner);
  if (!planner) return tl::unexpected(planner.error());
  const auto checker = internal::make_checker(problem, settings);
  if (!checker) return tl::unexpected(checker.error());

  SolveResult result;
  const PlanQuery query = {problem.start, problem.goals};
  if (auto refused = refuse_query(*checker, query)) {
    result.plan = *std::move(refused);
  } else if (internal::is_memory_sampler(settings.sampler) && database != nullptr) {
    auto planned = plan_with_memory(problem, *database, *checker, (*planner)->plan, complete,
                                    stopwatch.elapsed_s(), result);
    if (!planned) return tl::unexpected(planned.error());
    result.remembered = internal::remember(problem, result.plan, *database, complete);
  } else {
    PlanSettings plan = settings.plan;
    plan.timeout_s = std::max(0.0, plan.timeout_s - stopwatch.elapsed_s());
    result.plan = (*planner)->plan(*checker, query,
                                   *internal::make_sampler(problem.robot, complete, {}), plan);
  }
  result.planner = settings.planner;
  result.sampler = settings.sampler;
  result.seed = settings.plan.seed;
  result.isa = checker->isa();
  result.total_time_s = stopwatch.elapsed_s();
  result.planning_time_s = result.total_time_s - result.plan.simplification_time_s -
                           result.plan.verification_time_s - result.remembered.time_s;
  return result;
}

}  // namespace mneme
