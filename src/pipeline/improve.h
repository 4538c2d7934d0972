// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Improvement of a path in the time left.
#pragma once

#include "pipeline/resolve_goals.h"

namespace mneme::internal {

/// Shortens the path of `result` further, then plans again from other seeds and shortens the best
/// of a few paths, for PlanSettings::improve seconds. Keeps the shortest path that passes
/// verification, so that the path never becomes longer. `sampler` is the query's.
void improve(const ResolvedQuery& resolved, const Sampler& sampler, SolveResult& result);

}  // namespace mneme::internal
