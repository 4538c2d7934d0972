// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "bench_runs.h"

#include <algorithm>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <thread>
#include <tuple>

#include <fmt/format.h>

#include "bench_row.h"
#include "bench_solve.h"
#include "interrupt.h"

namespace mneme::app {
namespace {

/// What tells one run from another: set, problem, planner, sampler, setting and seed.
using RunName =
    std::tuple<std::string, std::string, std::string, std::string, std::string, std::uint64_t>;

struct BenchRun {
  const LoadedProblem* loaded = nullptr;
  const BenchCase* bench_case = nullptr;
  std::uint64_t seed = 0;
};

RunName name_of(const BenchmarkRow& row) {
  return {row.set, row.problem, row.planner, row.sampler, row.setting, row.seed};
}

RunName name_of(const BenchRun& run) {
  const SolveSettings& settings = run.bench_case->settings;
  return {run.loaded->set,  run.loaded->problem.name, settings.planner,
          settings.sampler, run.bench_case->setting,  run.seed};
}

bool is_of_set(const BenchCase& bench_case, const std::string& set) {
  const auto& sets = bench_case.sets;
  return sets.empty() || std::find(sets.begin(), sets.end(), set) != sets.end();
}

/// Of a problem's cases the first finds the caches cold; every other seed takes them in reverse, so
/// that it is not the same one each time.
std::vector<BenchRun> all_runs(const BenchPlan& plan) {
  std::vector<BenchRun> runs;
  for (int i = 0; i < plan.seed_count; ++i) {
    for (const LoadedProblem& loaded : plan.problems) {
      const std::size_t first = runs.size();
      for (const BenchCase& bench_case : plan.cases) {
        if (is_of_set(bench_case, loaded.set)) {
          runs.push_back({&loaded, &bench_case, plan.first_seed + static_cast<std::uint64_t>(i)});
        }
      }
      if (i % 2 == 1) std::reverse(runs.begin() + static_cast<std::ptrdiff_t>(first), runs.end());
    }
  }
  return runs;
}

std::vector<BenchRun> missing_runs(const BenchPlan& plan, std::span<const BenchmarkRow> done) {
  std::set<RunName> names;
  for (const BenchmarkRow& row : done) names.insert(name_of(row));
  std::vector<BenchRun> runs = all_runs(plan);
  std::erase_if(runs, [&](const BenchRun& run) { return names.contains(name_of(run)); });
  return runs;
}

/// Caches, page tables and the clock of the machine are cold at first.
void warm_up(const BenchRun& run) {
  SolveSettings settings;
  settings.sampler = "uniform";
  settings.plan.timeout_s = std::min(run.bench_case->settings.plan.timeout_s, 0.05);
  static_cast<void>(solve(run.loaded->problem, nullptr, settings));
}

/// Hands the runs to threads and their rows to the caller. Planners of OMPL run one at a time: they
/// draw from one sequence of random numbers, which repeats itself for none but a single run.
class RunQueue {
 public:
  RunQueue(BenchPlan& plan, const std::vector<BenchRun>& runs, const OnRow& on_row)
      : plan_(plan), on_row_(on_row), machine_(describe_machine()), version_(describe_build()) {
    for (const BenchRun& run : runs) {
      (is_ompl_planner(run.bench_case->settings.planner) ? ompl_ : native_).push_back(&run);
    }
  }

  Result<bool> run() {
    std::vector<std::thread> threads;
    for (int i = 1; i < plan_.jobs; ++i) threads.emplace_back([this] { work(); });
    work();
    for (std::thread& thread : threads) thread.join();
    if (error_) return tl::unexpected(*error_);
    return !is_interrupted_;
  }

 private:
  /// The next run that may start; null if there is none, because whoever runs a planner of OMPL
  /// goes on with the others. `last` is what the thread has just run.
  const BenchRun* take(const BenchRun* last) {
    const std::lock_guard lock(mutex_);
    if (last != nullptr && is_ompl_planner(last->bench_case->settings.planner))
      is_ompl_free_ = true;
    if (error_ || is_interrupted_) return nullptr;
    const bool has_ompl = is_ompl_free_ && !ompl_.empty();
    if (!has_ompl && native_.empty()) return nullptr;
    // All of the runs were in one array, so that addresses tell their order.
    const bool is_ompl = has_ompl && (native_.empty() || ompl_.front() < native_.front());
    std::deque<const BenchRun*>& queue = is_ompl ? ompl_ : native_;
    const BenchRun* run = queue.front();
    queue.pop_front();
    if (is_ompl) is_ompl_free_ = false;
    return run;
  }

  void work() {
    std::optional<CollisionChecker> checker;
    std::pair<const LoadedProblem*, double> checked{nullptr, 0};
    for (const BenchRun* run = take(nullptr); run != nullptr; run = take(run)) {
      CheckerSettings checking;
      checking.resolution = run->bench_case->settings.resolution;
      if (const std::pair key{run->loaded, checking.resolution}; key != checked) {
        const Problem& problem = run->loaded->problem;
        auto made = CollisionChecker::make(problem.robot, problem.scene, checking);
        if (!made) return stop(made.error());
        checker.emplace(std::move(*made));
        checked = key;
      }
      run_once(*run, *checker);
    }
  }

  void run_once(const BenchRun& run, const CollisionChecker& checker) {
    const Problem& problem = run.loaded->problem;
    SolveSettings settings = run.bench_case->settings;
    settings.plan.seed = run.seed;
    settings.plan.cancel = interrupt_flag();
    const auto memory = plan_.memories.find({run.bench_case->memory, problem.robot.hash()});
    Database* database = needs_memory(settings.sampler) && memory != plan_.memories.end()
                             ? &memory->second
                             : nullptr;
    const std::string started = current_time();
    const Result<SolveResult> result =
        solve_with_any(problem, database, settings, run.bench_case->is_ompl_as_in_paper,
                       run.bench_case->ompl_experience);
    if (!result) return stop(result.error());
    if (result->plan.status == PlanStatus::cancelled) {
      const std::lock_guard lock(mutex_);
      is_interrupted_ = true;
      return;
    }
    BenchmarkRow row = make_row(problem, settings, *result, checker);
    row.set = run.loaded->set;
    row.setting = run.bench_case->setting;
    row.settings = run.bench_case->description;
    row.machine = machine_;
    row.version = version_;
    row.started = started;
    const std::lock_guard lock(mutex_);
    if (const Result<void> taken = on_row_(row); !taken) error_ = taken.error();
  }

  void stop(const Error& error) {
    const std::lock_guard lock(mutex_);
    error_ = error;
  }

  BenchPlan& plan_;
  const OnRow& on_row_;
  std::deque<const BenchRun*> native_, ompl_;  ///< not started yet
  bool is_ompl_free_ = true;
  std::string machine_;
  std::string version_;
  std::mutex mutex_;
  std::optional<Error> error_;
  bool is_interrupted_ = false;
};

}  // namespace

std::size_t BenchPlan::run_count() const {
  std::size_t count = 0;
  for (const LoadedProblem& loaded : problems) {
    count += static_cast<std::size_t>(std::count_if(
        cases.begin(), cases.end(), [&](const BenchCase& c) { return is_of_set(c, loaded.set); }));
  }
  return count * static_cast<std::size_t>(seed_count);
}

void sort_rows(const BenchPlan& plan, std::vector<BenchmarkRow>& rows) {
  std::map<RunName, std::size_t> positions;
  for (const BenchRun& run : all_runs(plan)) positions.emplace(name_of(run), positions.size());
  const auto position = [&](const BenchmarkRow& row) {
    const auto found = positions.find(name_of(row));
    return found == positions.end() ? positions.size() : found->second;
  };
  std::ranges::stable_sort(rows, {}, position);
}

bool learns_while_planning(const SolveSettings& settings) {
  return settings.learn_budget_s > 0 || settings.remember_after >= 0;
}

void append_cases(const BenchCase& setting, const std::vector<std::string>& planners,
                  const std::vector<std::string>& samplers, std::vector<BenchCase>& cases) {
  for (const std::string& planner : planners) {
    for (const std::string& sampler : samplers) {
      BenchCase& added = cases.emplace_back(setting);
      added.settings.planner = planner;
      added.settings.sampler = sampler;
    }
  }
}

Result<void> check_same_settings(const BenchPlan& plan, std::span<const BenchmarkRow> rows) {
  for (const BenchmarkRow& row : rows) {
    const auto same = std::find_if(plan.cases.begin(), plan.cases.end(), [&](const BenchCase& c) {
      return c.setting == row.setting && c.settings.planner == row.planner &&
             c.settings.sampler == row.sampler;
    });
    if (same == plan.cases.end()) continue;
    const double timeout_s = same->settings.plan.timeout_s;
    if (row.timeout_s != timeout_s) {
      return fail(ErrorCode::invalid,
                  fmt::format("cannot resume: a run there had a time limit of {} s, not {} s",
                              row.timeout_s, timeout_s));
    }
    // Rows without a version come from a mneme that did not write settings down.
    if (!row.version.empty() && row.settings != same->description) {
      return fail(ErrorCode::invalid,
                  fmt::format("cannot resume: a run there had the settings '{}', not '{}'",
                              row.settings, same->description));
    }
  }
  return {};
}

Result<bool> run_bench(BenchPlan& plan, std::span<const BenchmarkRow> done, const OnRow& on_row) {
  const std::vector<BenchRun> runs = missing_runs(plan, done);
  if (!runs.empty()) warm_up(runs.front());
  return RunQueue(plan, runs, on_row).run();
}

}  // namespace mneme::app
