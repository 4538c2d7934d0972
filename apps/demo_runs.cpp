// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "demo_runs.h"

#include <algorithm>

#include "bench_row.h"
#include "interrupt.h"

namespace mneme::app {
namespace {

constexpr double kConnectTimeout = 5;
constexpr double kOtherTimeout = 2;

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
    outcome.rows.push_back(make_row(*cell.problem, settings, *result, *checker));
    on_run();
    if (result->plan.is_solved() && !outcome.first_solved) {
      outcome.first_solved = std::move(*result);
    }
  }
  return outcome;
}

}  // namespace mneme::app
