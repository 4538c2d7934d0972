// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/pipeline.h"

namespace mneme {

Result<Trajectory> make_trajectory(const Problem& problem, const SolveSettings& settings,
                                   const Path& path, const RateLimits& limits,
                                   const TrajectorySettings& timing) {
  // Its end, which may be none of the problem's goals, shows what exact geometry judged, too.
  const CheckerSettings checked{settings.resolution, settings.margin, settings.isa,
                                problem.constraints};
  const QueryChecker made =
      MNEME_TRY(make_query_checker(problem.robot, problem.scene, checked, {problem.start, path}));
  // Whoever forgoes verification of the path does not ask for corners that cut through obstacles.
  const Verification wanted = settings.plan.verification();
  const MotionVerifier verifier(made.checker,
                                wanted == Verification::none ? Verification::states : wanted);
  return parameterize(problem.robot, path, limits, timing, &verifier);
}

}  // namespace mneme
