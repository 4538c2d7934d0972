// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What a solved problem leaves in the memory.
#pragma once

#include "pipeline/resolve_goals.h"

#include <cstdint>

namespace mneme::internal {

/// Inserts what the path of a solved problem teaches, if `remember_after` allows it. Planning the
/// path has cost `planning_states`, improving not counted.
[[nodiscard]] Remembered remember(const ResolvedQuery& resolved, const PlanResult& plan,
                                  std::uint64_t planning_states);

}  // namespace mneme::internal
