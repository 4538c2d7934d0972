// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// The page to read first: resolve the goal -> replay a known task, or decompose the scene ->
// retrieve or learn local samplers -> synthesize one sampler -> plan -> shorten and verify ->
// improve -> remember.
#include "mneme/pipeline.h"

#include "pipeline/improve.h"
#include "pipeline/memory_steps.h"
#include "pipeline/query.h"
#include "pipeline/race.h"
#include "pipeline/recollection.h"
#include "pipeline/replay.h"
#include "pipeline/resolved_goals.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

namespace mneme {
namespace {

using internal::KindSettings;
using internal::MemoryRequest;
using internal::Query;
using internal::Recalled;

/// Algorithm 2 of the paper, "Create GL-Sampler", for one kind of memory.
Result<Recalled> recall(const MemoryRequest& request, const KindSettings& kind, GlSampler& gl) {
  const Stopwatch stopwatch;
  const double learned_before_s = gl.learning_time_s;
  auto primitives = decompose(request, kind);  // line 1
  if (!primitives) return tl::unexpected(primitives.error());
  std::vector<PrimitiveRetrieval> known;
  for (PrimitiveRetrieval& primitive : *primitives) {  // line 2
    if (request.is_over()) break;
    const auto done = retrieve(request, kind, primitive).and_then([&] {  // lines 3 to 5
      return learn(request, kind, primitive, gl.learning_time_s);        // lines 6 and 7
    });
    if (!done) return tl::unexpected(done.error());
    known.push_back(std::move(primitive));
  }
  Recalled recalled = synthesize(request, kind, known,  // line 10
                                 static_cast<SampleSource>(gl.primitives.size()));
  std::ranges::move(known, std::back_inserter(gl.primitives));
  gl.retrieval_time_s += stopwatch.elapsed_s() - (gl.learning_time_s - learned_before_s);
  return recalled;
}

/// The goal that was reached may be one that came while planning.
void add_reached_goal(const Robot& robot, SolveResult& result) {
  constexpr double kSame = 1e-6;  // of a path that has been through single precision
  if (!result.plan.is_solved()) return;
  const Configuration& end = result.plan.path.back();
  const auto is_end = [&](const Configuration& goal) { return robot.distance(goal, end) < kSame; };
  if (std::ranges::none_of(result.goals, is_end)) result.goals.push_back(end);
}

/// Memory is asked by the sampler: at once, or when the planner has drawn for long enough without.
/// Returns how many states planning looked at; improving comes after that.
Result<std::uint64_t> search(const Query& query, const PoseGoalSource* further_goals,
                             SolveResult& result) {
  const Stopwatch stopwatch;
  internal::Recollection recollection(query, recall);
  const std::shared_ptr<const Sampler> sampler = query.sampler.make(recollection);
  if (auto failure = recollection.failure()) return tl::unexpected(*std::move(failure));
  const double recall_time_s = stopwatch.elapsed_s();

  PlanSettings settings = query.settings.plan;
  settings.timeout_s = std::max(0.0, settings.timeout_s - query.stopwatch.elapsed_s());
  auto raced = internal::race({query, *sampler, settings, further_goals});
  if (!raced) return tl::unexpected(raced.error());
  if (auto failure = recollection.failure(raced->draws)) return tl::unexpected(*std::move(failure));
  const std::uint64_t states = raced->plan.states_checked;
  result.plan = std::move(raced->plan);
  result.plan.planning_time_s += recall_time_s;
  if (further_goals != nullptr) add_reached_goal(query.problem.robot, result);
  improve(query, *sampler, result);
  result.gl = recollection.take(raced->draws);
  return states;
}

/// A known task is replayed; otherwise, or if that fails, what it took is added to the search's
/// (but for its iterations, which Replay has), whose states it returns.
Result<std::uint64_t> plan(const Query& query, const PoseGoalSource* further_goals,
                           SolveResult& result) {
  PlanResult replayed = internal::replay(query, result.replay);
  if (replayed.is_solved()) {
    result.plan = std::move(replayed);
    improve(query, *make_uniform_sampler(query.problem.robot), result);
    return 0;
  }
  return search(query, further_goals, result).map([&](std::uint64_t states) {
    result.plan.states_checked += replayed.states_checked;
    result.plan.motions_checked += replayed.motions_checked;
    result.plan.planning_time_s += result.replay.time_s;
    return states;
  });
}

}  // namespace

Result<SolveResult> solve(const Problem& problem, Database* database,
                          const SolveSettings& settings) {
  const Stopwatch stopwatch;
  auto query = internal::make_query(problem, database, settings);
  if (!query) return tl::unexpected(query.error());
  SolveResult result;
  const Stopwatch goal_stopwatch;
  auto goals = internal::resolve_goals(*query);
  if (!goals) return tl::unexpected(goals.error());
  result.goal_time_s = goal_stopwatch.elapsed_s();
  result.goals = query->ends.goals;
  result.notes = query->notes;
  std::ranges::move(goals->notes, std::back_inserter(result.notes));
  if (!query->notes.empty()) result.scene = query->checker.scene();
  if (goals->refused) {
    result.plan = *std::move(goals->refused);
  } else {
    const auto states = plan(*query, goals->further.get(), result);
    if (!states) return tl::unexpected(states.error());
    if (!result.replay.is_hit()) result.remembered = remember(*query, result.plan, *states);
  }
  result.planner = query->planner.name;
  result.sampler = query->sampler.name;
  result.seed = settings.plan.seed;
  result.isa = query->checker.isa();
  result.total_time_s = stopwatch.elapsed_s();
  result.planning_time_s = result.total_time_s - result.plan.simplification_time_s -
                           result.plan.verification_time_s - result.improvement_time_s -
                           result.remembered.time_s;
  return result;
}

Result<GlSampler> create_gl_sampler(const MemoryQuery& query, Database& database,
                                    const SolveSettings& settings) {
  const auto request = internal::make_memory_request(query, &database, settings);
  if (!request) return tl::unexpected(request.error());
  GlSampler gl;
  GaussianMixture all;
  for (const KindSettings& kind : request->kinds) {
    auto recalled = recall(*request, kind, gl);
    if (!recalled) return tl::unexpected(recalled.error());
    internal::append(all, internal::make_all(*std::move(recalled), query.robot.joint_count()));
  }
  gl.mixture = std::make_shared<const GaussianMixture>(std::move(all));
  return gl;
}

Result<std::shared_ptr<const Sampler>> make_sampler(const Problem& problem, Database* database,
                                                    const SolveSettings& settings) {
  SolveSettings elsewhere = settings;
  elsewhere.plan.walk = 0;  // Planners of others go on no walks.
  auto query = internal::make_query(problem, database, elsewhere);
  if (!query) return tl::unexpected(query.error());
  int after = std::numeric_limits<int>::max();
  for (KindSettings& kind : query->kinds) {
    after = std::min(after, std::exchange(kind.retrieve_after, 0));
  }
  internal::Recollection recollection(*query, recall);
  std::shared_ptr<const Sampler> sampler = query->sampler.make(recollection);
  if (auto failure = recollection.failure()) return tl::unexpected(*std::move(failure));
  const bool is_asked = query->sampler.draws_from_memory && !query->kinds.empty();
  if (!is_asked || after == 0) return sampler;
  return make_lazy_sampler(make_uniform_sampler(problem.robot), after,
                           [rest = std::move(sampler)] { return rest; });
}

}  // namespace mneme
