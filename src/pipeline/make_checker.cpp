// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/make_checker.h"

namespace mneme::internal {

Result<CollisionChecker> make_checker(const Problem& problem, const SolveSettings& settings) {
  CheckerSettings checking;
  checking.resolution = settings.resolution;
  checking.margin = settings.margin;
  checking.isa = settings.isa;
  return CollisionChecker::make(problem.robot, problem.scene, checking);
}

}  // namespace mneme::internal
