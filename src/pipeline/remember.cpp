// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/remember.h"

#include "base/fail.h"
#include "path/push_off.h"
#include "pipeline/memory_steps.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace mneme::internal {
namespace {

/// A solved problem, for another thread: owns or shares all that it needs.
struct Solved {
  std::string problem;
  CollisionChecker checker;
  Configuration start;
  std::vector<Configuration> goals;
  std::vector<OrientationConstraint> constraints;
  Path path;
  FinishSettings finish;
  std::uint64_t planning_states = 0;
};

Result<std::vector<Experience>> make_rows(const Solved& solved, const KindSettings& kind,
                                          const std::atomic<bool>& stop) {
  FinishSettings finish = solved.finish;
  finish.cancel = &stop;
  const std::vector<Path> paths = {kind.replay > 0 ? widen(solved.checker, solved.path, finish)
                                                   : solved.path};
  const MemoryQuery query{solved.checker.robot().without_attached(), solved.checker.scene(),
                          &solved.start, solved.goals, solved.constraints};
  auto rows =
      MNEME_TRY(learn_from_paths(query, paths, {std::string(kind.kind->name), kind.max_gap}));
  for (Experience& row : rows) {
    if (row.is_path()) row.path().planning_states = solved.planning_states;
    row.provenance = provenance_of("solved problem " + solved.problem, solved.finish.seed);
  }
  return rows;
}

/// Error: that of the last kind that fails, if no kind makes rows.
Result<std::vector<Experience>> make_all_rows(const Solved& solved,
                                              const std::vector<KindSettings>& kinds,
                                              const std::atomic<bool>& stop) {
  Result<std::vector<Experience>> rows;
  std::vector<Experience> made;
  for (const KindSettings& kind : kinds) {
    if (stop) return fail(ErrorCode::io, "the database is closed");
    rows = make_rows(solved, kind, stop);
    if (rows) std::ranges::move(*rows, std::back_inserter(made));
  }
  if (!rows && made.empty()) return rows;
  return made;
}

Solved copy_of(const ResolvedQuery& resolved, const Path& path, std::uint64_t planning_states) {
  const Problem& problem = resolved.query.problem;
  FinishSettings finish = resolved.query.settings.plan.finish();
  finish.cancel = nullptr;  // it may not live as long
  return {
      problem.name, resolved.checker, resolved.ends.start, resolved.ends.goals, problem.constraints,
      path,         finish,           planning_states};
}

}  // namespace

Remembered remember(const ResolvedQuery& resolved, const PlanResult& plan,
                    const PlanningWork& work) {
  const Query& query = resolved.query;
  const std::optional<int> after = query.settings.remember_after;
  Remembered remembered;
  // Paths with OMPL's defaults are not verified: they teach nothing.
  const bool is_wanted =
      after && plan.is_solved() && query.database != nullptr && !query.settings.plan.ompl_defaults;
  if (!is_wanted) return remembered;
  const Stopwatch stopwatch;
  std::vector<KindSettings> kinds = query.kinds;
  std::erase_if(kinds, [&](const KindSettings& kind) {
    // Memory is not asked for what is planned so fast.
    const bool is_easy = kind.replay > 0 && work.iterations < query.ask_after.value_or(0);
    return is_easy || work.states + work.iterations < kind.kind->least_work ||
           (kind.kind->is_placed_by_checking && !query.problem.constraints.empty());
  });
  if (kinds.empty() ||
      !query.database->earns_row(work.iterations, static_cast<std::uint64_t>(*after))) {
    return remembered;
  }
  const auto queued = query.database->insert_later(
      [solved = copy_of(resolved, plan.path, work.states), kinds = std::move(kinds)](
          const std::atomic<bool>& stop) { return make_all_rows(solved, kinds, stop); });
  remembered.is_queued = queued.has_value();
  if (!queued) remembered.failure = queued.error().message;
  remembered.time_s = stopwatch.elapsed_s();
  return remembered;
}

}  // namespace mneme::internal
