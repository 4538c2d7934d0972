// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Goal configurations of a problem.
#pragma once

#include "pipeline/given_ends.h"
#include "pipeline/query.h"
#include "replay/proven_motions.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace mneme::internal {

/// A query with its goals as configurations, and the checker for the motions between the ends.
/// Immutable; refers to the query.
struct ResolvedQuery {
  const Query& query;
  PlanQuery ends;
  GivenEnds given = {};  ///< original ends, where `ends` has replacements
  CollisionChecker checker;
  std::shared_ptr<StaticCell> cell;  ///< of the checker, for replay; may be null
  /// Source of further goals, if the problem has poses.
  std::optional<PoseGoalSource> further_goals = {};
  /// For people: exceptions at the ends, pairs that are checked by exact geometry, ignored goals.
  std::vector<std::string> notes = {};
  bool has_exact_pairs = false;            ///< True if checker.scene() has more exact pairs.
  std::optional<PlanResult> refusal = {};  ///< set if start or goals cannot be planned
  double preparation_time_s = 0;           ///< making the checker; the time limit begins after it
};

/// Makes the checker, starts the time limit, finds configurations for the problem's poses, drops
/// goals in contact, and checks the ends. Of many goals it examines some until one is valid, and
/// adds those that are found valid within a tenth of the time limit. Errors: a scene that cannot be
/// checked; those of PoseGoalSource::make().
[[nodiscard]] Result<ResolvedQuery> resolve_goals(const Query& query);
/// Returns a result without a plan.
[[nodiscard]] SolveResult describe(const ResolvedQuery& resolved);

}  // namespace mneme::internal
