// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "bench_runs.h"

#include <set>
#include <tuple>

#include "bench_row.h"
#include "interrupt.h"

namespace mneme::app {
namespace {

/// What tells one run from another.
using RunName = std::tuple<std::string, std::string, std::string, std::string, std::uint64_t>;

/// Caches, page tables and the clock of the machine are cold at first.
void warm_up(const BenchPlan& plan) {
  SolveSettings settings = plan.settings;
  settings.sampler = "uniform";
  settings.planner = plan.planners.front();
  settings.plan.timeout_s = std::min(settings.plan.timeout_s, 0.05);
  static_cast<void>(solve(plan.problems.front().problem, nullptr, settings));
}

/// Runs one problem with one seed.
class ProblemRuns {
 public:
  ProblemRuns(BenchPlan& plan, const LoadedProblem& loaded, const CollisionChecker& checker,
              std::uint64_t seed)
      : plan_(plan), loaded_(loaded), checker_(checker), settings_(plan.settings) {
    settings_.plan.seed = seed;
    settings_.plan.cancel = interrupt_flag();
  }

  /// False if it was interrupted.
  Result<bool> run(const std::set<RunName>& done, const OnRow& on_row) {
    for (const std::string& planner : plan_.planners) {
      for (const std::string& sampler : plan_.samplers) {
        const RunName name{loaded_.set, loaded_.problem.name, planner, sampler,
                           settings_.plan.seed};
        if (done.count(name) > 0) continue;
        settings_.planner = planner;
        settings_.sampler = sampler;
        const Result<bool> goes_on = run_once(on_row);
        if (!goes_on || !*goes_on) return goes_on;
      }
    }
    return true;
  }

 private:
  Result<bool> run_once(const OnRow& on_row) {
    const auto memory = plan_.memories.find(loaded_.problem.robot.hash());
    Database* database =
        settings_.sampler == "gl" && memory != plan_.memories.end() ? &memory->second : nullptr;
    const Result<SolveResult> result = solve(loaded_.problem, database, settings_);
    if (!result) return tl::unexpected(result.error());
    if (result->plan.status == PlanStatus::cancelled) return false;
    BenchmarkRow row = make_row(loaded_.problem, settings_, *result, checker_);
    row.set = loaded_.set;
    return on_row(row).map([] { return true; });
  }

  BenchPlan& plan_;
  const LoadedProblem& loaded_;
  const CollisionChecker& checker_;
  SolveSettings settings_;
};

}  // namespace

Result<bool> run_bench(BenchPlan& plan, std::span<const BenchmarkRow> done, const OnRow& on_row) {
  std::set<RunName> names;
  for (const BenchmarkRow& row : done) {
    names.emplace(row.set, row.problem, row.planner, row.sampler, row.seed);
  }
  if (names.size() < plan.run_count()) warm_up(plan);
  CheckerSettings checking;
  checking.resolution = plan.settings.resolution;
  for (int i = 0; i < plan.seed_count; ++i) {
    const std::uint64_t seed = plan.settings.plan.seed + static_cast<std::uint64_t>(i);
    for (const LoadedProblem& loaded : plan.problems) {
      const auto checker =
          CollisionChecker::make(loaded.problem.robot, loaded.problem.scene, checking);
      if (!checker) return tl::unexpected(checker.error());
      const Result<bool> goes_on = ProblemRuns(plan, loaded, *checker, seed).run(names, on_row);
      if (!goes_on || !*goes_on) return goes_on;
    }
  }
  return true;
}

}  // namespace mneme::app
