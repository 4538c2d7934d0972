// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Searches of one query at once, each from a seed of its own.
#pragma once

#include "pipeline/resolve_goals.h"

#include <cstdint>
#include <limits>

namespace mneme::internal {

/// What is searched. Refers to both.
struct RaceTask {
  const ResolvedQuery& resolved;
  const Sampler& sampler;
};

struct RaceResult {
  PlanResult plan;  ///< of the search that won; its counts are that search's alone
  /// Configurations that it drew, or so many that it does not matter if there was no other search.
  std::uint64_t draws = std::numeric_limits<std::uint64_t>::max();
};

/// Runs as many searches as SolveSettings::threads says. The first one begins alone and the others
/// once it has taken a while; unless the settings say when, these go on escape walks at once. Of
/// those that find a path the one wins that took the fewest iterations since then, of several the
/// first, and all others end as soon as they cannot win any more. Which one wins depends neither on
/// timing nor on how many threads could be started, but for the time limit. All of them share the
/// limit on nodes. An observer sees the search that won, which is run again for it. Errors: those
/// of the planner.
[[nodiscard]] Result<RaceResult> race(const RaceTask& task);

}  // namespace mneme::internal
