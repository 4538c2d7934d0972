// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/pipeline.h"

#include "replay/proven_motions.h"

namespace mneme {

Result<Trajectory> make_trajectory(const Problem& problem, const SolveSettings& settings,
                                   const Path& path, const RateLimits& limits,
                                   const TrajectorySettings& timing) {
  // All waypoints count as goals, so that the same pairs as in solve() are checked exactly.
  const CheckerSettings checked{settings.resolution, settings.margin, settings.isa,
                                problem.constraints};
  const QueryChecker made = MNEME_TRY(
      internal::query_checker_of(problem.robot, problem.scene, checked, {problem.start, path}));
  // Even without verification of the path, corners must not cut through obstacles.
  const Verification wanted = settings.plan.verification();
  const MotionVerifier verifier(made.checker,
                                wanted == Verification::none ? Verification::states : wanted);
  return parameterize(problem.robot, path, limits, timing, &verifier, problem.start_velocity);
}

}  // namespace mneme
