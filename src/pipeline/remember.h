// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Insertion of solved problems into memory.
#pragma once

#include "pipeline/resolve_goals.h"

#include <cstdint>

namespace mneme::internal {

/// Work of planning a path, without improving it.
struct PlanningWork {
  std::uint64_t states = 0, iterations = 0;
};

/// Queues the experience of a solved problem if `remember_after` allows it: the database's thread
/// makes the rows.
[[nodiscard]] Remembered remember(const ResolvedQuery& resolved, const PlanResult& plan,
                                  const PlanningWork& work);

}  // namespace mneme::internal
