// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Insertion of solved problems into memory.
#pragma once

#include "pipeline/resolve_goals.h"

#include <cstdint>

namespace mneme::internal {

/// Queues the experience of a solved problem if `remember_after` allows it: the database's thread
/// makes the rows. `planning_states`: number of states checked for planning the path, without
/// improvement.
[[nodiscard]] Remembered remember(const ResolvedQuery& resolved, const PlanResult& plan,
                                  std::uint64_t planning_states);

}  // namespace mneme::internal
