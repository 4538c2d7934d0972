// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Algorithm 2 with whole queries as primitives.
#pragma once

#include "mneme/pipeline.h"

namespace mneme::internal {

/// Retrieves the paths whose ends are most similar to the problem's, goal by goal, and bends them
/// to it. The settings are complete; `database` is of the decomposer "paths".
[[nodiscard]] Result<GlSampler> recall_paths(const Problem& problem, const Database& database,
                                             const SolveSettings& settings);

}  // namespace mneme::internal
