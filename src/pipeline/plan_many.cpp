// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/pipeline.h"

#include "base/threads.h"

#include <memory>
#include <thread>

namespace mneme {
namespace {

Result<TimedSolution> plan_one(const Problem& problem, Database* database,
                               const ManySettings& settings) {
  SolveSettings solving = settings.solve;
  if (settings.timing) {
    solving.plan.limits = std::make_shared<const RateLimits>(
        MNEME_TRY(find_rate_limits(problem.robot, *settings.timing)));
  }
  TimedSolution solution{MNEME_TRY(solve(problem, database, solving)), {}};
  if (!settings.timing || !solution.result.plan.is_solved()) return solution;
  const Trajectory trajectory = MNEME_TRY(make_trajectory(
      problem, solving, solution.result.plan.path, *solving.plan.limits, *settings.timing));
  solution.trajectory = MNEME_TRY(trajectory.sample(settings.timing->dt));
  return solution;
}

}  // namespace

Result<std::vector<Result<TimedSolution>>> plan_many(std::span<const Problem> problems,
                                                     Database* database,
                                                     const ManySettings& settings) {
  const SolveSettings& solving = settings.solve;
  if (solving.learn_budget_s > 0 || solving.remember_after || solving.plan.observer != nullptr) {
    return fail(ErrorCode::invalid,
                "plan_many: learn-budget, remember-after and observers make results depend on the "
                "order of the problems; plan them one by one instead");
  }
  std::vector<Result<TimedSolution>> solutions(problems.size());
  const auto jobs = settings.jobs > 0 ? static_cast<std::size_t>(settings.jobs)
                                      : std::thread::hardware_concurrency();
  internal::run_parallel(problems.size(), jobs, [&](std::size_t i) {
    solutions[i] = plan_one(problems[i], database, settings);
  });
  return solutions;
}

}  // namespace mneme
