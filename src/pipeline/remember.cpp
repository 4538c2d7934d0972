// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/remember.h"

#include "path/push_off.h"

#include <algorithm>

namespace mneme::internal {
namespace {

Result<int> insert_solved(const ResolvedQuery& resolved, const Path& path, const KindSettings& kind,
                          std::uint64_t planning_states) {
  const Query& query = resolved.query;
  const PlanSettings& plan = query.settings.plan;
  const std::vector<Path> paths = {kind.replay > 0 ? widen(resolved.checker, path, plan.finish())
                                                   : path};
  auto rows = MNEME_TRY(
      learn_from_paths(memory_query(query.problem, resolved.ends.start, resolved.ends.goals), paths,
                       {std::string(kind.kind->name), kind.max_gap}));
  if (rows.empty()) return 0;
  for (Experience& row : rows) {
    if (row.is_path()) row.path().planning_states = planning_states;
    row.provenance = {
        "mneme " + std::string(version()), "solved problem " + query.problem.name, plan.seed, {}};
  }
  if (query.database->is_queued()) {
    const auto count = static_cast<int>(rows.size());
    MNEME_TRY(query.database->insert_later(std::move(rows)));
    return count;
  }
  std::vector<bool> is_new;
  MNEME_TRY(query.database->insert(std::move(rows), &is_new));
  return static_cast<int>(std::ranges::count(is_new, true));
}

}  // namespace

Remembered remember(const ResolvedQuery& resolved, const PlanResult& plan,
                    std::uint64_t planning_states) {
  const Query& query = resolved.query;
  const std::optional<int> after = query.settings.remember_after;
  Remembered remembered;
  // Paths with OMPL's defaults are not verified: they teach nothing.
  const bool is_wanted =
      after && plan.is_solved() && query.database != nullptr &&
      !query.settings.plan.ompl_defaults &&
      query.database->earns_row(plan.iterations, static_cast<std::uint64_t>(*after));
  if (!is_wanted) return remembered;
  const Stopwatch stopwatch;
  for (const KindSettings& kind : query.kinds) {
    if (planning_states + plan.iterations < kind.kind->least_work) continue;
    if (kind.kind->is_placed_by_checking && !query.problem.constraints.empty()) continue;
    if (const auto rows = insert_solved(resolved, plan.path, kind, planning_states)) {
      remembered.rows += *rows;
      remembered.is_queued = *rows > 0 && query.database->is_queued();
    } else {
      remembered.failure = rows.error().message;
    }
  }
  remembered.time_s = stopwatch.elapsed_s();
  return remembered;
}

}  // namespace mneme::internal
