// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// From the goals of a problem to configurations that a planner can be given.
#pragma once

#include "pipeline/query.h"

#include <memory>
#include <optional>

namespace mneme::internal {

struct ResolvedGoals {
  /// Of further ones, if the problem has poses.
  std::unique_ptr<PoseGoalSource> further;
  std::vector<std::string> notes;  ///< about goals that were left out
  /// Why start and goals cannot be planned between.
  std::optional<PlanResult> refused;
};

/// Adds configurations for the problem's poses to the ends of `query`, which it refers to, within
/// its time limit, leaves goals in contact out, and checks the ends. Errors: those of PoseGoalSource::make().
[[nodiscard]] Result<ResolvedGoals> resolve_goals(Query& query);

}  // namespace mneme::internal
