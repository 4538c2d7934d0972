// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Known tasks: a remembered path instead of a search.
#pragma once

#include "mneme/memory.h"
#include "mneme/planning.h"
#include "mneme/replay.h"

#include "replay/proven_motions.h"

namespace mneme::internal {

/// A query and the memory of tasks that may answer it. Refers to all of it.
struct ReplayTask {
  const Database& database;
  const MemoryKind& kind;  ///< one that keeps whole paths: it has `bend`
  double max_gap = 0;      ///< for its decompose()
  double distance = 0;     ///< largest distance of a known task that is tried
  const MemoryQuery& memory_query;
  const PlanQuery& ends;
  const CollisionChecker& checker;
  StaticCell* cell = nullptr;  ///< the checker's; may be null
  const PlanSettings& settings;
};

/// Bends the remembered paths whose ends are nearest to the query's and returns the first that
/// passes the verification of paths; if none does, repairs the one with the shortest blocks.
/// Without a path the result holds the work alone, which does not depend on how hard the query is
/// but on what planning the remembered path has cost: see kShareOfPlanning.
[[nodiscard]] PlanResult replay(const ReplayTask& task, Replay& report);

}  // namespace mneme::internal
