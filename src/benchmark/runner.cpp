// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/benchmark.h"
#include "mneme/baselines.h"

#include "base/threads.h"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <mutex>
#include <set>
#include <tuple>

namespace mneme {
namespace {

/// Identity of a run: set, problem, planner, sampler, setting and seed.
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

RunName name_without_seed(RunName name) {
  std::get<std::uint64_t>(name) = 0;
  return name;
}

std::vector<BenchRun> all_runs(const BenchPlan& plan) {
  std::vector<BenchRun> runs;
  for (int i = 0; i < plan.seed_count; ++i) {
    for (const LoadedProblem& loaded : plan.problems) {
      const std::size_t first = runs.size();
      for (const BenchCase& bench_case : plan.cases) {
        if (bench_case.is_of_set(loaded.set)) {
          runs.push_back({&loaded, &bench_case, plan.first_seed + static_cast<std::uint64_t>(i)});
        }
      }
      if (plan.alternates && i % 2 == 1)
        std::reverse(runs.begin() + static_cast<std::ptrdiff_t>(first), runs.end());
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

/// Warms caches, page tables and the processor's clock.
void warm_up(const BenchRun& run, const std::atomic<bool>* cancel) {
  SolveSettings settings;
  settings.plan.cancel = cancel;
  settings.sampler = "uniform";
  settings.plan.timeout_s = std::min(run.bench_case->settings.plan.timeout_s, 0.05);
  static_cast<void>(solve(run.loaded->problem, nullptr, settings));
}

/// Runs of a case on a problem so far.
struct Record {
  int runs = 0;
  bool is_solved = false;
};

/// Distributes runs to threads and passes their rows to the caller.
class RunQueue {
 public:
  RunQueue(BenchPlan& plan, const std::vector<BenchRun>& runs, std::span<const BenchmarkRow> done,
           const OnRow& on_row)
      : plan_(plan), on_row_(on_row), machine_(describe_machine()), version_(describe_build()) {
    for (const BenchRun& run : runs) {
      (run.bench_case->is_serial ? serial_ : parallel_).push_back(&run);
    }
    for (const BenchmarkRow& row : done) remember(row);
  }

  Result<bool> run() {
    internal::Threads others(static_cast<std::size_t>(std::max(plan_.jobs, 1) - 1),
                             [this] { work(); });
    work();
    others.join();
    if (error_) return tl::unexpected(*error_);
    return !is_cancelled_;
  }

 private:
  /// The next run that may start; null if there is none. A thread that ends a serial run continues
  /// with the remaining serial ones. `last` is the thread's previous run.
  const BenchRun* take(const BenchRun* last) {
    const std::lock_guard lock(mutex_);
    if (last != nullptr && last->bench_case->is_serial) is_turn_free_ = true;
    while (!error_ && !is_cancelled_) {
      const bool has_serial = is_turn_free_ && !serial_.empty();
      if (!has_serial && parallel_.empty()) return nullptr;
      // All runs are in one array, so that addresses give their order.
      const bool is_serial =
          has_serial && (parallel_.empty() || serial_.front() < parallel_.front());
      std::deque<const BenchRun*>& queue = is_serial ? serial_ : parallel_;
      const BenchRun* run = queue.front();
      queue.pop_front();
      if (is_hopeless(*run)) continue;
      if (is_serial) is_turn_free_ = false;
      return run;
    }
    return nullptr;
  }

  [[nodiscard]] bool is_hopeless(const BenchRun& run) const {
    const auto found = records_.find(name_without_seed(name_of(run)));
    return plan_.hopeless_after > 0 && found != records_.end() && !found->second.is_solved &&
           found->second.runs >= plan_.hopeless_after;
  }

  void remember(const BenchmarkRow& row) {
    Record& record = records_[name_without_seed(name_of(row))];
    ++record.runs;
    record.is_solved |= row.is_solved;
  }

  void work() {
    std::optional<CollisionChecker> checker;
    std::pair<const LoadedProblem*, std::optional<double>> checked{nullptr, {}};
    for (const BenchRun* run = take(nullptr); run != nullptr; run = take(run)) {
      CheckerSettings checking;
      checking.resolution = run->bench_case->settings.resolution;
      if (const std::pair key{run->loaded, checking.resolution}; key != checked) {
        const Problem& problem = run->loaded->problem;
        checking.constraints = problem.constraints;
        auto made = CollisionChecker::make(problem.robot, problem.scene, checking);
        if (!made) return stop(made.error());
        checker.emplace(std::move(*made));
        checked = key;
      }
      run_once(*run, *checker);
    }
  }

  [[nodiscard]] Database* memory_of(const BenchRun& run) const {
    const auto found =
        plan_.memories.find({run.bench_case->memory, run.loaded->problem.robot.hash()});
    const bool is_used =
        needs_memory(run.bench_case->settings.sampler) && found != plan_.memories.end();
    return is_used ? found->second.get() : nullptr;
  }

  void run_once(const BenchRun& run, const CollisionChecker& checker) {
    const Problem& problem = run.loaded->problem;
    BenchCase bench_case = *run.bench_case;
    bench_case.settings.plan.seed = run.seed;
    bench_case.settings.plan.cancel = plan_.cancel;
    const std::string started = current_time();
    const Result<SolveResult> result = plan_.solve(problem, memory_of(run), bench_case);
    if (!result) return stop(result.error());
    if (result->plan.status == PlanStatus::cancelled) {
      const std::lock_guard lock(mutex_);
      is_cancelled_ = true;
      return;
    }
    BenchmarkRow row = make_row(problem, bench_case.settings, *result, checker);
    row.set = run.loaded->set;
    row.setting = bench_case.setting;
    row.settings = bench_case.description;
    row.machine = machine_;
    row.version = version_;
    row.started = started;
    const std::lock_guard lock(mutex_);
    remember(row);
    if (const Result<void> taken = on_row_(row, *result); !taken) error_ = taken.error();
  }

  void stop(const Error& error) {
    const std::lock_guard lock(mutex_);
    error_ = error;
  }

  BenchPlan& plan_;
  const OnRow& on_row_;
  std::deque<const BenchRun*> parallel_, serial_;  ///< not started yet
  bool is_turn_free_ = true;                       ///< no serial run is active
  std::map<RunName, Record> records_;              ///< without seeds
  std::string machine_;
  std::string version_;
  std::mutex mutex_;
  std::optional<Error> error_;
  bool is_cancelled_ = false;
};

}  // namespace

Result<SolveResult> solve_case(const Problem& problem, Database* database,
                               const BenchCase& bench_case) {
  const SolveSettings& settings = bench_case.settings;
  const Rival* rival = find_rival(settings.planner);
  if (rival == nullptr) return solve(problem, database, settings);
  return rival->solve(problem, database, settings).map([&](SolveResult result) {
    result.planner = settings.planner;
    result.sampler = settings.sampler;
    return result;
  });
}

std::size_t BenchPlan::run_count() const {
  std::size_t count = 0;
  for (const LoadedProblem& loaded : problems) {
    count += static_cast<std::size_t>(std::count_if(
        cases.begin(), cases.end(), [&](const BenchCase& c) { return c.is_of_set(loaded.set); }));
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
  return settings.learn_budget_s > 0 || settings.remember_after.has_value();
}

void append_cases(const BenchCase& setting, const std::vector<std::string>& planners,
                  const std::vector<std::string>& samplers, std::vector<BenchCase>& cases) {
  for (const std::string& planner : planners) {
    const auto entry = find_planner(planner);
    for (const std::string& sampler : samplers) {
      BenchCase& added = cases.emplace_back(setting);
      added.settings.planner = planner;
      added.is_serial = entry && (*entry)->is_exclusive;
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
                  fmt::format("cannot resume: an earlier run had a time limit of {} s, not {} s",
                              row.timeout_s, timeout_s));
    }
    // Rows without a version are from before settings were recorded.
    if (!row.version.empty() && row.settings != same->description) {
      return fail(ErrorCode::invalid,
                  fmt::format("cannot resume: an earlier run had the settings '{}', not '{}'",
                              row.settings, same->description));
    }
  }
  return {};
}

Result<bool> run_bench(BenchPlan& plan, std::span<const BenchmarkRow> done, const OnRow& on_row) {
  const std::vector<BenchRun> runs = missing_runs(plan, done);
  if (!runs.empty()) warm_up(runs.front(), plan.cancel);
  return RunQueue(plan, runs, done, on_row).run();
}

}  // namespace mneme
