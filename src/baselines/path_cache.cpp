// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// A path cache like MoveIt 2's (moveit_ros trajectory_cache, DOI 10.5281/zenodo.11215428). It
// returns the fastest path that was planned between similar ends, without checking it in the scene.
// docs/design/baselines.md lists the departures.
#include "pipeline/memory_steps.h"
#include "baselines/solvers.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

namespace mneme::internal {
namespace {

enum class Rank { fastest, nearest };

struct Entry {
  std::int64_t row = 0;
  double similarity_error = 0;  ///< similarity error of the ends
  double duration_s = 0;        ///< duration of the trajectory
  Path path;                    ///< with the query's ends
};

Path stored_path(const MemoryQuery& query, const Configuration& goal, const Experience& row) {
  const std::vector<float>& waypoints = row.path().waypoints;
  const auto joints = static_cast<std::ptrdiff_t>(row.path().joint_count);
  Path path;
  for (auto q = waypoints.begin(); q != waypoints.end(); q += joints) {
    path.push_back(query.robot.normalized(Configuration(q, q + joints)));
  }
  path.front() = query.robot.normalized(*query.start);
  path.back() = query.robot.normalized(goal);
  return path;
}

/// Rows with ends within KindSettings::replay of the query's. Reversed paths are excluded.
Result<std::vector<Entry>> find_entries(const Query& query) {
  const MemoryQuery request = memory_query(query.problem);
  std::vector<Entry> entries;
  for (const KindSettings& kind : query.kinds) {
    if (!(kind.replay > 0)) continue;
    const auto primitives = MNEME_TRY(decompose(request, kind));
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      const LocalPrimitive& primitive = primitives[i].primitive;
      const auto rows = MNEME_TRY(query.database->find(kind.kind->version, {&primitive.key, 1},
                                                       kind.replay * kind.replay, 0, nullptr,
                                                       primitive.constraints));
      for (const KeyMatch& row : rows) {
        if (row.experience->path().waypoint_count() < 2) continue;
        entries.push_back({row.experience->id, row.similarity_error, 0,
                           stored_path(request, request.goals[i], *row.experience)});
      }
    }
  }
  return entries;
}

/// A real cache stores durations with its trajectories, so computing them is not timed.
void add_durations(const Robot& robot, std::vector<Entry>& entries) {
  const auto limits = find_rate_limits(robot);
  if (!limits) return;
  for (Entry& entry : entries) {
    const auto trajectory = parameterize(robot, entry.path, *limits, {}, nullptr);
    if (trajectory) entry.duration_s = trajectory->duration_s();
  }
}

bool is_free(const CollisionChecker& checker, const Path& path, PlanResult& work) {
  CheckCounters counters;
  const Stopwatch stopwatch;
  const bool is_free = find_invalid_motion(checker, path, counters) < 0;
  work.verification_time_s += stopwatch.elapsed_s();
  work.states_checked += counters.states;
  work.motions_checked += counters.motions;
  return is_free;
}

/// Plans without memory after a lookup without result that took `lookup_s`.
Result<SolveResult> plan_instead(const Problem& problem, SolveSettings settings, double lookup_s) {
  settings.sampler = "uniform";
  return solve(problem, nullptr, settings).map([&](SolveResult result) {
    result.plan.planning_time_s += lookup_s;
    result.total_time_s += lookup_s;
    return result;
  });
}

bool are_ends_within_limits(const Problem& problem) {
  const auto is_within = [&](const Configuration& q) {
    return !problem.robot.describe_violation(q, "end");
  };
  return is_within(problem.start) && std::ranges::all_of(problem.goals, is_within);
}

Result<SolveResult> fetch(const Problem& problem, Database* database, const SolveSettings& given,
                          Rank rank, bool checks_scene) {
  const Stopwatch stopwatch;
  const SolveSettings settings = with_own_planner(given);
  // Nothing is remembered for such ends, and solve() says what is wrong with them.
  if (!are_ends_within_limits(problem)) return plan_instead(problem, settings, 0);
  const Query query = MNEME_TRY(make_query(problem, database, settings));
  auto entries = MNEME_TRY(find_entries(query));
  const Stopwatch ranking;
  if (rank == Rank::fastest && entries.size() > 1) add_durations(problem.robot, entries);
  const double ranking_s = ranking.elapsed_s();
  std::ranges::stable_sort(entries, {},
                           rank == Rank::fastest ? &Entry::duration_s : &Entry::similarity_error);
  double tables_s = 0;
  std::optional<CollisionChecker> checker;
  if (checks_scene) {
    const Stopwatch making;
    QueryChecker made = MNEME_TRY(make_query_checker(
        problem.robot, problem.scene, query.checker_settings(), {problem.start, problem.goals}));
    checker = std::move(made.checker);
    tables_s = making.elapsed_s();
  }
  SolveResult result;
  const auto found = std::ranges::find_if(entries, [&](const Entry& entry) {
    return !checker || is_free(*checker, entry.path, result.plan);
  });
  const double total_s = stopwatch.elapsed_s() - ranking_s;
  if (found == entries.end()) return plan_instead(problem, settings, total_s);
  result.plan.status = PlanStatus::solved;
  result.plan.path = std::move(found->path);
  result.plan.planning_time_s = total_s - tables_s - result.plan.verification_time_s;
  result.planning_time_s = result.plan.planning_time_s;
  result.total_time_s = total_s;
  result.replay.row = found->row;
  result.goals = problem.goals;
  result.seed = settings.plan.seed;
  return result;
}

}  // namespace

Result<SolveResult> fetch_fastest(const Problem& problem, Database* database,
                                  const SolveSettings& settings) {
  return fetch(problem, database, settings, Rank::fastest, false);
}

Result<SolveResult> fetch_nearest(const Problem& problem, Database* database,
                                  const SolveSettings& settings) {
  return fetch(problem, database, settings, Rank::nearest, false);
}

Result<SolveResult> fetch_free(const Problem& problem, Database* database,
                               const SolveSettings& settings) {
  return fetch(problem, database, settings, Rank::fastest, true);
}

}  // namespace mneme::internal
