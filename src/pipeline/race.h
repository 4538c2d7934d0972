// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Simultaneous searches for one query from different seeds.
#pragma once

#include "pipeline/motion_memory.h"

#include <cstdint>
#include <limits>

namespace mneme::internal {

/// Refers to its arguments.
struct RaceTask {
  const ResolvedQuery& resolved;
  const Sampler& sampler;
  /// Asked by the first search; ends all searches before others begin. Null: none.
  SearchLimit* limit = nullptr;
};

struct RaceResult {
  PlanResult plan;  ///< of the winner; its counts do not include other searches
  /// Number of samples of the winner; the largest value if it was the only search.
  std::uint64_t samples = std::numeric_limits<std::uint64_t>::max();
  FoundMotions found;
};

/// Runs SolveSettings::threads searches. The others begin after kAlone iterations of the first one;
/// unless the settings say otherwise, they walk from their first iteration on. The search that
/// found a path in the fewest iterations since then wins; ties go to the lowest index. Searches end
/// once they cannot win. The winner does not depend on timing or on the number of threads that
/// could be started, except through the time limit. Searches share the limit of nodes. The winner
/// is run again for an observer. Errors: those of the planner.
[[nodiscard]] Result<RaceResult> race(const RaceTask& task);

}  // namespace mneme::internal
