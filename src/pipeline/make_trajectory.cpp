// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/pipeline.h"

#include "pipeline/query.h"
#include "pipeline/trajectory_checker.h"
#include "replay/proven_motions.h"

#include <utility>

namespace mneme {

Result<internal::TrajectoryChecker> internal::make_trajectory_checker(const Problem& problem,
                                                                      const SolveSettings& settings,
                                                                      const Path& path) {
  // All waypoints count as goals, so that the same pairs as in solve() are checked exactly.
  QueryChecker made = MNEME_TRY(query_checker_of(problem.robot, problem.scene,
                                                 checker_settings_of(settings, problem.constraints),
                                                 {problem.start, path}));
  // Even without verification of the path, corners must not cut through obstacles.
  const Verification wanted = settings.plan.verification();
  return TrajectoryChecker{std::move(made.checker),
                           wanted == Verification::none ? Verification::states : wanted};
}

Result<Trajectory> make_trajectory(const Problem& problem, const SolveSettings& settings,
                                   const Path& path, const RateLimits& limits,
                                   const TrajectorySettings& timing) {
  const internal::TrajectoryChecker made =
      MNEME_TRY(internal::make_trajectory_checker(problem, settings, path));
  const MotionVerifier verifier = made.verifier();
  return parameterize(problem.robot, path, limits, timing, &verifier, problem.start_velocity,
                      problem.end_velocity);
}

}  // namespace mneme
