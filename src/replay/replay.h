// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Replay of known tasks: a remembered path instead of a search.
#pragma once

#include "mneme/memory.h"
#include "mneme/planning.h"
#include "mneme/replay.h"

#include "replay/proven_motions.h"

namespace mneme::internal {

/// A query and a memory of tasks. Refers to its arguments.
struct ReplayTask {
  const Database& database;
  const MemoryKind& kind;  ///< must be able to replay
  double max_gap = 0;      ///< MemorySettings::max_gap, for decompose() of the kind
  double distance = 0;     ///< largest distance of a known task to try
  const MemoryQuery& memory_query;
  const PlanQuery& ends;
  const CollisionChecker& checker;
  StaticCell* cell = nullptr;  ///< cell of the checker; may be null
  const PlanSettings& settings;
};

/// Deforms the remembered paths with the nearest ends to the query's ends, and returns the first
/// that passes verification. If none passes, repairs the one with the shortest stretches in
/// contact. If that fails, too, the result holds only the work done, which is limited by the cost
/// of planning the remembered path: see kShareOfPlanning.
[[nodiscard]] PlanResult replay(const ReplayTask& task, Replay& report);

}  // namespace mneme::internal
