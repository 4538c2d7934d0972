// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The checker that proves motions near a path.
#pragma once

#include "mneme/pipeline.h"

namespace mneme::internal {

/// Must outlive its verifiers.
struct TrajectoryChecker {
  CollisionChecker checker;
  Verification verification = Verification::motions;

  [[nodiscard]] MotionVerifier verifier() const { return MotionVerifier(checker, verification); }
};

/// Checks the same pairs exactly as solve() did for `path`. Errors: as make_query_checker().
[[nodiscard]] Result<TrajectoryChecker> make_trajectory_checker(const Problem& problem,
                                                                const SolveSettings& settings,
                                                                const Path& path);

}  // namespace mneme::internal
