// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/pipeline.h"

#include "base/threads.h"
#include "pipeline/motion_memory.h"
#include "pipeline/resolve_goals.h"

namespace mneme {
namespace {

/// Further searches of a problem: each takes another way through a passage.
constexpr std::uint64_t kSearches = 2;
constexpr std::uint64_t kStudyTask = std::uint64_t{1} << 60;
/// Seconds between two looks at the cancel flag while rows are stored.
constexpr double kPatience = 0.02;

/// Keeps the places of all motions for later queries in the scene.
Result<void> place_motions(const Problem& problem, Database& database,
                           const SolveSettings& settings) {
  const internal::Query query = MNEME_TRY(internal::make_query(problem, &database, settings));
  const internal::ResolvedQuery resolved = MNEME_TRY(internal::resolve_goals(query));
  if (resolved.cell == nullptr || !internal::MotionMemory::is_used(query)) return {};
  internal::MotionMemory motions(resolved);
  std::vector<PlacedMotion> placed;
  CheckCounters counters;
  while (!query.is_over() && motions.find_more(placed, counters)) placed.clear();
  resolved.cell->places().add(motions.take_found().places);
  return {};
}

/// Waits until the queued rows are stored. Error: io, if none is stored for as long as a search may
/// take.
Result<void> wait_for_rows(Database& database, const PlanSettings& settings) {
  Stopwatch idle;
  std::int64_t waiting = 0;
  for (;;) {
    const Result<void> stored = database.flush(kPatience);
    if (stored || internal::is_set(settings.cancel)) return {};
    const std::int64_t left = database.queued_rows().waiting;
    if (left != waiting) idle = Stopwatch();
    waiting = left;
    if (idle.elapsed_s() > settings.timeout_s) return stored;
  }
}

}  // namespace

Result<void> study(const Problem& problem, Database& database, const SolveSettings& settings) {
  SolveSettings search = settings;
  search.replay = 0;
  search.remember_after = 0;
  search.plan.observer = nullptr;
  const auto is_cancelled = [&] { return internal::is_set(settings.plan.cancel); };
  for (std::uint64_t i = 0; i < kSearches && !is_cancelled(); ++i) {
    search.plan.seed = derive_seed(settings.plan.seed, kStudyTask + i);
    MNEME_TRY(solve(problem, &database, search));
  }
  MNEME_TRY(wait_for_rows(database, search.plan));
  if (is_cancelled()) return {};
  return place_motions(problem, database, search);
}

}  // namespace mneme
