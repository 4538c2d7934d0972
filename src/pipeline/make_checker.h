// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The collision checker that a call of solve() plans with.
#pragma once

#include "mneme/collision.h"
#include "mneme/pipeline.h"

namespace mneme::internal {

/// Errors: those of CollisionChecker::make.
[[nodiscard]] Result<CollisionChecker> make_checker(const Problem& problem,
                                                    const SolveSettings& settings);

}  // namespace mneme::internal
