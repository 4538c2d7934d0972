// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/resolved_goals.h"

#include "base/threads.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace mneme::internal {

namespace {

/// The poses were not looked at for long enough: nothing is known of them.
PlanResult refuse_unresolved(const Query& query) {
  PlanResult refused;
  refused.status = is_set(query.settings.plan.cancel) ? PlanStatus::cancelled : PlanStatus::timeout;
  refused.message = refused.status == PlanStatus::cancelled
                        ? "cancelled"
                        : "no configuration for the poses of the goal within the time limit";
  return refused;
}

IkSettings ik_settings(const Query& query) {
  IkSettings settings = query.settings.ik;
  settings.seed = query.settings.plan.seed;
  settings.is_over = [&query] { return query.is_over(); };
  return settings;
}

Result<PoseGoalSource> make_source(const Query& query) {
  return PoseGoalSource::make(query.checker, query.problem.pose_goals, query.problem.start,
                              ik_settings(query), kVerificationMargin);
}

/// True if some configuration for a pose touches with spheres only: then the checker has become one
/// that judges these by exact geometry.
Result<bool> judge_poses_exactly(Query& query) {
  constexpr int kMostSolutions = 64;
  const Problem& problem = query.problem;
  IkSettings settings = ik_settings(query);
  settings.solutions = std::max(settings.solutions, kMostSolutions);
  for (const PoseGoal& goal : problem.pose_goals) {
    if (query.is_over()) return false;
    const auto kinematics = InverseKinematics::make(problem.robot, goal.link, query.checker.isa());
    if (!kinematics) return tl::unexpected(kinematics.error());
    const IkResult reached = kinematics->solve(goal, problem.start, settings);
    for (const Configuration& q : reached.solutions) {
      if (query.is_over()) return false;
      auto made = make_query_checker(problem, query.settings, {q});
      if (!made) return tl::unexpected(made.error());
      if (made->notes.size() <= query.notes.size()) continue;
      query.checker = std::move(made->checker);
      query.notes = std::move(made->notes);
      query.cell = nullptr;
      return true;
    }
  }
  return false;
}

/// The source of configurations for poses, of which the first are among `goals`.
Result<PoseGoalSource> resolve_poses(Query& query, std::vector<Configuration>& goals) {
  auto source = make_source(query);
  if (!source) return source;
  std::vector<Configuration> found = source->more();
  if (found.empty() && goals.empty()) {
    const auto is_exact = judge_poses_exactly(query);
    if (!is_exact) return tl::unexpected(is_exact.error());
    if (*is_exact) {
      source = make_source(query);
      if (source) found = source->more();
    }
  }
  std::ranges::move(found, std::back_inserter(goals));
  return source;
}

}  // namespace

Result<ResolvedGoals> resolve_goals(Query& query) {
  const Problem& problem = query.problem;
  ResolvedGoals resolved;
  const bool has_start = !problem.robot.describe_violation(problem.start, "start");
  if (!problem.pose_goals.empty() && has_start) {
    auto source = resolve_poses(query, query.ends.goals);
    if (!source) return tl::unexpected(source.error());
    resolved.further = std::make_unique<PoseGoalSource>(*std::move(source));
    // Without any goal the refusal says it.
    if (!query.ends.goals.empty()) resolved.notes = resolved.further->describe_unreached();
  }
  const bool are_ends_clear = query.are_ends_clear && problem.pose_goals.empty();
  if (!are_ends_clear) {
    std::ranges::move(drop_goals_in_contact(query.checker, query.ends.goals),
                      std::back_inserter(resolved.notes));
  }
  query.query.goals = query.ends.goals;
  resolved.refused = refuse_query(query.checker, query.ends, are_ends_clear);
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
