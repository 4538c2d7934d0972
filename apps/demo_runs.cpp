// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "demo_runs.h"

#include <algorithm>

#include "interrupt.h"

namespace mneme::app {
namespace {

constexpr double kConnectTimeout = 5;
constexpr double kOtherTimeout = 2;
constexpr double kSameConfiguration = 1e-4;

/// Checks a path without trusting anything that helped to find it.
bool is_path_valid(const CollisionChecker& checker, const Problem& problem, const Path& path) {
  const Robot& robot = problem.robot;
  const auto is_goal = [&](const Configuration& goal) {
    return robot.distance(path.back(), goal) < kSameConfiguration;
  };
  const auto is_within_limits = [&](const Configuration& q) {
    return !robot.describe_violation(q, "waypoint");
  };
  return !path.empty() && robot.distance(path.front(), problem.start) < kSameConfiguration &&
         std::any_of(problem.goals.begin(), problem.goals.end(), is_goal) &&
         std::all_of(path.begin(), path.end(), is_within_limits) &&
         is_path_free(checker, path, checker.resolution() / kVerificationRefinement);
}

BenchmarkRow make_row(const DemoCell& cell, const SolveResult& result,
                      const CollisionChecker& checker) {
  BenchmarkRow row;
  row.problem = cell.problem->name;
  row.planner = cell.planner;
  row.sampler = cell.sampler;
  row.seed = result.seed;
  row.is_solved = result.plan.is_solved();
  row.is_path_valid = row.is_solved && is_path_valid(checker, *cell.problem, result.plan.path);
  row.planning_time_s = row.is_solved ? result.planning_time_s : cell.timeout_s;
  row.total_time_s = result.total_time_s;
  row.retrieval_time_s = result.gl.retrieval_time_s;
  row.iterations = result.plan.iterations;
  row.states_checked = result.plan.states_checked;
  row.path_length = path_length(cell.problem->robot, result.plan.path);
  row.components = result.gl.mixture ? result.gl.mixture->component_count() : 0;
  return row;
}

bool is_hopeless(std::span<const BenchmarkRow> rows) {
  return rows.size() == kHopelessRuns &&
         std::none_of(rows.begin(), rows.end(), [](const BenchmarkRow& r) { return r.is_solved; });
}

}  // namespace

std::vector<DemoCell> demo_cells(std::span<const Problem> problems,
                                 std::optional<double> timeout_s) {
  std::vector<DemoCell> cells;
  for (const Problem& problem : problems) {
    for (const char* planner : {"rrt_connect", "prm", "rrt"}) {
      const bool is_connect = std::string_view(planner) == "rrt_connect";
      const double limit = timeout_s.value_or(is_connect ? kConnectTimeout : kOtherTimeout);
      for (const char* sampler : {"gl", "uniform"}) {
        cells.push_back({&problem, planner, sampler, limit});
      }
    }
  }
  return cells;
}

Result<DemoOutcome> run_cell(const DemoCell& cell, Database& database, int seed_count,
                             const std::function<void()>& on_run) {
  const auto checker = CollisionChecker::make(cell.problem->robot, cell.problem->scene);
  if (!checker) return tl::unexpected(checker.error());
  SolveSettings settings;
  settings.planner = cell.planner;
  settings.sampler = cell.sampler;
  settings.plan.timeout_s = cell.timeout_s;
  settings.plan.cancel = interrupt_flag();
  Database* memory = cell.sampler == "gl" ? &database : nullptr;
  DemoOutcome outcome;
  for (int seed = 1; seed <= seed_count && !is_hopeless(outcome.rows); ++seed) {
    settings.plan.seed = static_cast<std::uint64_t>(seed);
    Result<SolveResult> result = solve(*cell.problem, memory, settings);
    if (!result) return tl::unexpected(result.error());
    outcome.is_interrupted = result->plan.status == PlanStatus::cancelled;
    if (outcome.is_interrupted) return outcome;
    outcome.rows.push_back(make_row(cell, *result, *checker));
    on_run();
    if (result->plan.is_solved() && !outcome.first_solved) {
      outcome.first_solved = std::move(*result);
    }
  }
  return outcome;
}

}  // namespace mneme::app
