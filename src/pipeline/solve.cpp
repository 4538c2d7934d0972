// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Read this file first. resolve goals -> decompose the scene -> retrieve or learn local samplers ->
// synthesize one sampler -> plan, or replay a known task -> shorten, verify -> improve -> remember.
#include "mneme/pipeline.h"

#include "base/threads.h"
#include "pipeline/improve.h"
#include "pipeline/known_answer.h"
#include "pipeline/memory_sampler.h"
#include "pipeline/memory_steps.h"
#include "pipeline/moving_ends.h"
#include "pipeline/race.h"
#include "pipeline/remember.h"
#include "pipeline/resolve_goals.h"
#include "pipeline/unsolved.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <string>
#include <utility>

namespace mneme {
namespace {

using internal::KindSettings;
using internal::KnownAnswer;
using internal::MemorySampler;
using internal::Query;
using internal::Recalled;
using internal::ResolvedQuery;

/// Algorithm 2 of the paper, "Create GL-Sampler", for one kind of memory.
Result<Recalled> recall(const Query& query, const MemoryQuery& memory_query,
                        const KindSettings& kind, GlSampler& gl) {
  const Stopwatch stopwatch;
  const double learned_before_s = gl.learning_time_s;
  std::vector<PrimitiveRetrieval> known;
  for (PrimitiveRetrieval& primitive : MNEME_TRY(decompose(memory_query, kind))) {  // lines 1, 2
    if (query.is_over()) break;
    MNEME_TRY(retrieve(*query.database, kind, primitive));                       // lines 3 to 5
    MNEME_TRY(learn(query, memory_query, kind, primitive, gl.learning_time_s));  // lines 6 and 7
    known.push_back(std::move(primitive));
  }
  Recalled recalled = synthesize(memory_query, kind, known,  // line 10
                                 static_cast<SampleSource>(gl.primitives.size()));
  std::ranges::move(known, std::back_inserter(gl.primitives));
  gl.retrieval_time_s += stopwatch.elapsed_s() - (gl.learning_time_s - learned_before_s);
  return recalled;
}

/// Keeps what a search has learned about the memory's motions.
void note_motions(const ResolvedQuery& resolved, const internal::FoundMotions& found) {
  const Query& query = resolved.query;
  if (!query.may_change_memory()) return;
  if (resolved.cell) resolved.cell->places().add(found.places);
  query.database->book(found.kind, found.states, found.saved);
}

/// Searches with samples from memory, until `known` answers.
Result<void> search(const ResolvedQuery& resolved, KnownAnswer& known, SolveResult& result) {
  MemorySampler memory(resolved, recall);
  const auto sampler = MNEME_TRY(memory.make());
  internal::RaceResult planned = MNEME_TRY(internal::race({resolved, *sampler, &known}));
  result.plan = std::move(planned.plan);
  result.plan.planning_time_s += memory.time_s();
  if (result.plan.status == PlanStatus::iteration_limit) known.ask_at_last();
  if (known.has_answered()) return {};
  MNEME_TRY(memory.check(planned.samples));
  const internal::PlanningWork work{result.plan.states_checked, result.plan.iterations};
  note_motions(resolved, planned.found);
  improve(resolved, *sampler, result);
  result.gl = memory.take(planned.samples);
  known.add_work(result.plan);
  result.remembered = remember(resolved, result.plan, work);
  remember_unsolved(resolved, result.plan);
  return {};
}

/// Adds a goal that was found while planning.
void add_reached_goal(const Robot& robot, SolveResult& result) {
  if (!result.plan.is_solved()) return;
  const Configuration& end = result.plan.path.back();
  const auto is_end = [&](const Configuration& goal) {
    return internal::is_same_end(robot, goal, end);
  };
  if (std::ranges::none_of(result.goals, is_end)) result.goals.push_back(end);
}

/// The problem with attached objects checked against obstacles that they may touch; nothing if
/// there are none.
std::optional<Problem> without_allowed_contact(const Problem& problem) {
  const auto is_attached = [&](const std::string& name) { return problem.robot.is_attached(name); };
  const auto allows = [&](const Obstacle& obstacle) {
    return std::ranges::any_of(obstacle.may_touch, is_attached);
  };
  if (std::ranges::none_of(problem.scene.obstacles, allows)) return std::nullopt;
  Problem stricter = problem;
  for (Obstacle& obstacle : stricter.scene.obstacles) {
    std::erase_if(obstacle.may_touch, is_attached);
  }
  return stricter;
}

void add_times(double total_time_s, SolveResult& result) {
  result.total_time_s = total_time_s;
  result.planning_time_s = total_time_s - result.preparation_time_s -
                           result.plan.simplification_time_s - result.plan.verification_time_s -
                           result.improvement_time_s - result.remembered.time_s;
}

Result<SolveResult> solve_as_given(const Problem& problem, Database* database,
                                   const SolveSettings& settings) {
  const Stopwatch stopwatch;
  const Query query = MNEME_TRY(internal::make_query(problem, database, settings));
  const Stopwatch goal_stopwatch;
  const auto made = internal::unless_cancelled(settings.plan.cancel,
                                               [&] { return internal::resolve_goals(query); });
  if (!made) {
    return internal::unplanned(settings, PlanStatus::cancelled, "cancelled", stopwatch.elapsed_s());
  }
  if (!*made) return tl::unexpected(made->error());
  const ResolvedQuery& resolved = **made;
  SolveResult result = internal::describe(resolved);
  result.goal_time_s = goal_stopwatch.elapsed_s() - result.preparation_time_s;
  KnownAnswer known(resolved, result.replay);
  if (resolved.refusal) {
    result.plan = *resolved.refusal;
  } else if (known.needs_search()) {
    MNEME_TRY(search(resolved, known, result));
  }
  if (known.has_answered()) {
    result.plan = known.take(result.plan);
    // Remembered paths are improved already.
    if (result.plan.is_solved() && settings.plan.improve > 0) {
      improve(resolved, *make_uniform_sampler(problem.robot), result);
    }
  }
  result.plan.path = resolved.given.completed(problem.robot, std::move(result.plan.path));
  result.plan.path = unwrapped(problem.robot, std::move(result.plan.path), problem.start);
  if (resolved.further_goals) add_reached_goal(problem.robot, result);
  add_times(stopwatch.elapsed_s(), result);
  return result;
}

}  // namespace

Result<SolveResult> solve(const Problem& problem, Database* database,
                          const SolveSettings& settings) {
  if (problem.is_moving()) {
    return internal::solve_moving(problem, settings,
                                  [&](const Problem& resting, const SolveSettings& left) {
                                    return solve(resting, database, left);
                                  });
  }
  const auto stricter =
      settings.allow_at_ends > 0 ? without_allowed_contact(problem) : std::nullopt;
  if (!stricter) return solve_as_given(problem, database, settings);
  const Stopwatch stopwatch;
  SolveSettings part = settings;
  part.plan.timeout_s *= 0.5;
  SolveResult kept = MNEME_TRY(solve_as_given(*stricter, database, part));
  if (kept.plan.is_solved() || kept.plan.status == PlanStatus::cancelled) return kept;
  const double spent_s = stopwatch.elapsed_s() - kept.preparation_time_s;
  part.plan.timeout_s = std::max(0.0, settings.plan.timeout_s - spent_s);
  SolveResult result = MNEME_TRY(solve_as_given(problem, database, part));
  result.total_time_s += kept.total_time_s;
  result.planning_time_s += kept.planning_time_s;
  result.preparation_time_s += kept.preparation_time_s;
  if (result.plan.is_solved()) {
    result.notes.push_back(
        "allowed contact of attached objects also occurs between start and goal: no path was found "
        "without it (" +
        kept.plan.message + ")");
  }
  return result;
}

Result<std::shared_ptr<const Sampler>> make_sampler(const Problem& problem, Database* database,
                                                    const SolveSettings& settings) {
  SolveSettings elsewhere = settings;
  elsewhere.plan.walk = 0;  // planners of other libraries do not walk
  const Query query = MNEME_TRY(internal::make_query(problem, database, elsewhere));
  const ResolvedQuery resolved = MNEME_TRY(internal::resolve_goals(query));
  MemorySampler memory(resolved, recall, MemorySampler::Timing::at_once);
  std::shared_ptr<const Sampler> sampler = MNEME_TRY(memory.make());
  if (memory.retrieve_after() == 0) return sampler;
  return make_lazy_sampler(make_uniform_sampler(problem.robot), memory.retrieve_after(),
                           [rest = std::move(sampler)] { return rest; });
}

}  // namespace mneme
