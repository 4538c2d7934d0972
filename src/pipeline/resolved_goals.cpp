// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/resolved_goals.h"

#include <algorithm>
#include <atomic>
#include <iterator>
#include <utility>

namespace mneme::internal {

namespace {

/// The poses were not looked at for long enough: nothing is known of them.
PlanResult refuse_unresolved(const Query& query) {
  const std::atomic<bool>* cancel = query.settings.plan.cancel;
  PlanResult refused;
  refused.status =
      cancel != nullptr && cancel->load() ? PlanStatus::cancelled : PlanStatus::timeout;
  refused.message = refused.status == PlanStatus::cancelled
                        ? "cancelled"
                        : "no configuration for the poses of the goal within the time limit";
  return refused;
}

}  // namespace

Result<ResolvedGoals> resolve_goals(Query& query) {
  const Problem& problem = query.problem;
  ResolvedGoals resolved;
  const bool has_start = !problem.robot.describe_violation(problem.start, "start");
  if (!problem.pose_goals.empty() && has_start) {
    IkSettings settings = query.settings.ik;
    settings.seed = query.settings.plan.seed;
    settings.is_over = [&query] { return query.is_over(); };
    auto source = PoseGoalSource::make(query.checker, problem.pose_goals, problem.start, settings,
                                       kVerificationMargin);
    if (!source) return tl::unexpected(source.error());
    std::ranges::move(source->more(), std::back_inserter(query.ends.goals));
    resolved.further = std::make_unique<PoseGoalSource>(*std::move(source));
  }
  resolved.notes = drop_goals_in_contact(query.checker, query.ends.goals);
  query.query.goals = query.ends.goals;
  resolved.refused = refuse_query(query.checker, query.ends);
  const bool is_for_want_of_goals = resolved.refused && query.ends.goals.empty() &&
                                    resolved.refused->status == PlanStatus::invalid_goal &&
                                    resolved.further != nullptr;
  if (is_for_want_of_goals && query.is_over()) {
    resolved.refused = refuse_unresolved(query);
  } else if (is_for_want_of_goals) {
    resolved.refused->message = resolved.further->describe_failure();
  }
  return resolved;
}

}  // namespace mneme::internal
