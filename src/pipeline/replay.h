// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Known tasks: a remembered path instead of a search.
#pragma once

#include "pipeline/query.h"

namespace mneme::internal {

/// Bends the remembered paths whose ends are nearest to the query's, as KindSettings::replay says,
/// and takes the first that passes the query's verification; if none does, leads one round what
/// blocks it. `told` hears what became of them. Without a path the result has the work alone, which
/// does not depend on how hard the query is, but on what planning the path has cost: see
/// kShareOfPlanning.
[[nodiscard]] PlanResult replay(const Query& query, Replay& told);

}  // namespace mneme::internal
