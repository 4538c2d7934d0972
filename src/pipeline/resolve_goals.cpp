// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/resolve_goals.h"

#include "base/threads.h"
#include "planning/end_contacts.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace mneme::internal {
namespace {

IkSettings ik_settings(const Query& query) {
  IkSettings settings = query.settings.ik;
  settings.seed = query.settings.plan.seed;
  settings.is_over = [&query] { return query.is_over(); };
  return settings;
}

Result<CellChecker> make_checker(const Query& query, const PlanQuery& ends,
                                 const GivenEnds& given) {
  const Problem& problem = query.problem;
  return make_query_checker(problem.robot, problem.scene, query.checker_settings(), ends,
                            given.names(ends))
      .map([](QueryChecker made) {
        return CellChecker{std::move(made), nullptr};
      });
}

/// Replaces ends that are barely outside by configurations nearby.
Result<GivenEnds> move_inside(const Query& query, CellChecker& made, PlanQuery& ends) {
  const SolveSettings& settings = query.settings;
  const bool has_tolerance = settings.start_tolerance > 0 || settings.allow_at_ends > 0 ||
                             !query.problem.scene.end_contacts.empty();
  if (made.checked.are_ends_clear || !has_tolerance) return GivenEnds{};
  // The exact geometry may show that start and goals are free.
  const CollisionChecker& checker = made.checked.checker;
  const auto is_clear_end = [&](const Configuration& q) {
    return !checker.robot().describe_violation(q, "") && is_clear(checker, q);
  };
  if (is_clear_end(ends.start) && std::ranges::all_of(ends.goals, is_clear_end)) {
    return GivenEnds{};
  }
  GivenEnds given = move_ends_inside(query, made.checked.checker, ends);
  if (!given.empty()) made = MNEME_TRY(make_checker(query, ends, given));
  return given;
}

Result<PoseGoalSource> make_source(const Query& query, const CollisionChecker& checker) {
  return PoseGoalSource::make(checker, query.problem.pose_goals, query.problem.start,
                              ik_settings(query), kVerificationMargin);
}

/// Returns a checker with more exact pairs, found at a configuration for a pose where only spheres
/// are in contact; nothing if there is none.
Result<std::optional<QueryChecker>> find_exact_checker(const Query& query,
                                                       const QueryChecker& checked) {
  constexpr int kMostSolutions = 64;
  const Problem& problem = query.problem;
  IkSettings settings = ik_settings(query);
  settings.solutions = std::max(settings.solutions, kMostSolutions);
  for (const PoseGoal& goal : problem.pose_goals) {
    if (query.is_over()) return std::nullopt;
    const auto kinematics =
        MNEME_TRY(InverseKinematics::make(problem.robot, goal.link, checked.checker.isa()));
    const IkResult reached = kinematics.solve(goal, problem.start, settings);
    for (const Configuration& q : reached.solutions) {
      if (query.is_over()) return std::nullopt;
      QueryChecker made = MNEME_TRY(make_query_checker(
          problem.robot, problem.scene, query.checker_settings(), {problem.start, {q}}));
      if (made.notes.size() > checked.notes.size()) return made;
    }
  }
  return std::nullopt;
}

/// Adds configurations for the problem's poses to `ends`.
Result<void> resolve_poses(const Query& query, CellChecker& made, PlanQuery& ends,
                           std::optional<PoseGoalSource>& further_goals) {
  further_goals = MNEME_TRY(make_source(query, made.checked.checker));
  std::vector<Configuration> found = further_goals->more();
  if (found.empty() && ends.goals.empty()) {
    if (auto exact = MNEME_TRY(find_exact_checker(query, made.checked))) {
      made = {*std::move(exact), nullptr};
      further_goals = MNEME_TRY(make_source(query, made.checked.checker));
      found = further_goals->more();
    }
  }
  std::ranges::move(found, std::back_inserter(ends.goals));
  return {};
}

/// Takes configurations for the poses in which an attached object touches what it is put on, or a
/// pair of Scene::end_contacts touches.
Result<void> enter_contact(const Query& query, CellChecker& made, PlanQuery& ends, GivenEnds& given,
                           std::vector<Configuration> blocked) {
  const Problem& problem = query.problem;
  const bool holds = query.settings.allow_at_ends > 0 && !problem.robot.attached().empty();
  if (!holds && problem.scene.end_contacts.empty()) return {};
  PlanQuery tried{ends.start, std::move(blocked)};
  GivenEnds entered = move_ends_inside(query, made.checked.checker, tried);
  if (entered.goals.empty()) return {};
  for (const GivenEnds::Goal& goal : entered.goals) ends.goals.push_back(goal.inside);
  std::ranges::move(entered.goals, std::back_inserter(given.goals));
  std::ranges::move(entered.notes, std::back_inserter(given.notes));
  made = MNEME_TRY(make_checker(query, ends, given));
  return {};
}

/// Explains in `refusal` why no configuration was found for the poses.
void explain_missing_goals(const ResolvedQuery& resolved, PlanResult& refusal) {
  const Query& query = resolved.query;
  if (!query.is_over()) {
    refusal.message = resolved.further_goals->describe_failure();
  } else if (is_set(query.settings.plan.cancel)) {
    refusal.status = PlanStatus::cancelled;
    refusal.message = "cancelled";
  } else {
    refusal.status = PlanStatus::timeout;
    refusal.message = "no configuration for the poses of the goal within the time limit";
  }
}

}  // namespace

Result<ResolvedQuery> resolve_goals(const Query& query) {
  const Problem& problem = query.problem;
  PlanQuery ends{problem.start, problem.goals};
  const Stopwatch preparing;
  CellChecker made =
      MNEME_TRY(find_or_make_checker(problem.robot, problem.scene, query.checker_settings(), ends));
  const double preparation_time_s = preparing.elapsed_s();
  query.stopwatch = Stopwatch();
  GivenEnds given = MNEME_TRY(move_inside(query, made, ends));
  std::optional<PoseGoalSource> further_goals;
  const bool has_start = !problem.robot.describe_violation(ends.start, "start");
  if (!problem.pose_goals.empty() && has_start) {
    MNEME_TRY(resolve_poses(query, made, ends, further_goals));
    if (ends.goals.empty()) {
      MNEME_TRY(enter_contact(query, made, ends, given, further_goals->blocked()));
    }
  }
  const bool are_ends_clear = made.checked.are_ends_clear && problem.pose_goals.empty();
  const bool has_exact_pairs = !made.checked.notes.empty();
  ResolvedQuery resolved{query,
                         std::move(ends),
                         std::move(given),
                         std::move(made.checked.checker),
                         std::move(made.cell),
                         std::move(further_goals),
                         {},
                         has_exact_pairs,
                         {},
                         preparation_time_s};
  const auto add_notes = [&](std::vector<std::string> notes) {
    std::ranges::move(notes, std::back_inserter(resolved.notes));
  };
  add_notes(resolved.given.notes);
  add_notes(std::move(made.checked.notes));
  const bool has_poses = resolved.further_goals.has_value();
  // Without any goal the refusal explains it.
  if (has_poses && !resolved.ends.goals.empty()) {
    add_notes(resolved.further_goals->describe_unreached());
  }
  add_notes(drop_invalid_goals(resolved.checker, resolved.ends.goals, are_ends_clear));
  resolved.refusal = refuse_query(resolved.checker, resolved.ends, are_ends_clear);
  if (has_poses && resolved.refusal && resolved.ends.goals.empty() &&
      resolved.refusal->status == PlanStatus::invalid_goal) {
    explain_missing_goals(resolved, *resolved.refusal);
  }
  return resolved;
}

SolveResult describe(const ResolvedQuery& resolved) {
  SolveResult result;
  result.goals = resolved.ends.goals;
  for (const GivenEnds::Goal& goal : resolved.given.goals) {
    std::ranges::replace(result.goals, goal.inside, goal.given);
  }
  result.notes = resolved.notes;
  if (resolved.has_exact_pairs) result.scene = resolved.checker.scene();
  result.preparation_time_s = resolved.preparation_time_s;
  result.planner = resolved.query.planner.name;
  result.sampler = resolved.query.sampler.name;
  result.seed = resolved.query.settings.plan.seed;
  result.isa = resolved.checker.isa();
  return result;
}

}  // namespace mneme::internal
