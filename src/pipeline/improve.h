// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Better paths with more time.
#pragma once

#include "pipeline/resolve_goals.h"

namespace mneme::internal {

/// Shortens the path of `result` further, then plans anew from other seeds and shortens the best of
/// a few, for as long as PlanSettings::improve says. Keeps the shortest path that passes the
/// query's verification, so that it is never longer than before. `sampler` is the query's.
void improve(const ResolvedQuery& resolved, const Sampler& sampler, SolveResult& result);

}  // namespace mneme::internal
