// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/benchmark.h"
#include "mneme/baselines.h"

#include "base/fail.h"
#include "base/text.h"
#include "base/threads.h"

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

/// Appends the runs of a problem with the seed of that index, in the order of that turn.
void append_runs(const BenchPlan& plan, const LoadedProblem& loaded, int seed, int turn,
                 std::vector<BenchRun>& runs) {
  const auto first = static_cast<std::ptrdiff_t>(runs.size());
  for (const BenchCase& bench_case : plan.cases) {
    if (!bench_case.is_of_set(loaded.set)) continue;
    runs.push_back({&loaded, &bench_case, plan.first_seed + static_cast<std::uint64_t>(seed)});
  }
  if (!plan.alternates || std::ssize(runs) == first) return;
  if (turn % 2 == 1) std::reverse(runs.begin() + first, runs.end());
  const std::ptrdiff_t shift = turn / 2 % (std::ssize(runs) - first);
  std::rotate(runs.begin() + first, runs.begin() + first + shift, runs.end());
}

std::vector<BenchRun> all_runs(const BenchPlan& plan) {
  std::vector<BenchRun> runs;
  if (plan.is_warm()) {
    int turn = 0;
    for (const LoadedProblem& loaded : plan.problems) {
      for (int i = 0; i < plan.seed_count; ++i) append_runs(plan, loaded, i, turn + i, runs);
      ++turn;
    }
  } else {
    for (int i = 0; i < plan.seed_count; ++i) {
      for (const LoadedProblem& loaded : plan.problems) append_runs(plan, loaded, i, i, runs);
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

/// Limit of a run that only warms caches, seconds.
constexpr double kWarmUp = 0.05;

/// Runs of a case on a problem so far.
struct Record {
  int runs = 0;
  bool is_solved = false;
};

/// A run whose path is not checked yet.
struct TimedRun {
  const BenchRun* run;
  BenchCase bench_case;  ///< with the run's seed
  SolveResult result;
  std::string started;
};

/// Checkers of one problem by resolution, for the exact checks, and what these have found.
class ProblemCheckers {
 public:
  Result<const CollisionChecker*> find(const LoadedProblem& loaded,
                                       std::optional<double> resolution) {
    if (&loaded != loaded_) {
      checkers_.clear();
      verdicts_.clear();
    }
    loaded_ = &loaded;
    if (const auto found = checkers_.find(resolution); found != checkers_.end()) {
      return &found->second;
    }
    CheckerSettings settings;
    settings.resolution = resolution;
    settings.constraints = loaded.problem.constraints;
    auto made =
        MNEME_TRY(CollisionChecker::make(loaded.problem.robot, loaded.problem.scene, settings));
    return &checkers_.emplace(resolution, std::move(made)).first->second;
  }

  /// What the check of the same path has found; nothing if it was not checked.
  [[nodiscard]] std::optional<bool> verdict_on(const TimedRun& run) const {
    const auto found = verdicts_.find(key_of(run));
    return found == verdicts_.end() || run.result.scene ? std::nullopt
                                                        : std::optional(found->second);
  }
  void keep(const TimedRun& run, const BenchmarkRow& row) {
    if (row.is_solved && !run.result.scene) verdicts_.emplace(key_of(run), row.is_path_valid);
  }

 private:
  /// All that the verdict on a path of the problem depends on.
  using Key = std::tuple<std::optional<double>, double, double, Path>;

  static Key key_of(const TimedRun& run) {
    const SolveSettings& settings = run.bench_case.settings;
    return {settings.resolution, settings.start_tolerance, settings.allow_at_ends,
            run.result.plan.path};
  }

  const LoadedProblem* loaded_ = nullptr;
  std::map<std::optional<double>, CollisionChecker> checkers_;
  std::map<Key, bool> verdicts_;
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
    for (const BenchmarkRow& row : done) remember(name_of(row), row.is_solved);
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
  /// Runs that a thread takes together: one, or some of a problem in a row if they are timed warm.
  using Batch = std::vector<const BenchRun*>;

  void work() {
    ProblemCheckers checkers;
    for (Batch batch = take({}); !batch.empty(); batch = take(batch)) run_batch(batch, checkers);
  }

  /// Returns the next runs that may start; empty if there are none. `last` are the previous runs of
  /// the thread. A thread whose last runs were serial continues with the remaining serial runs.
  Batch take(const Batch& last) {
    const std::lock_guard lock(mutex_);
    if (!last.empty() && last.front()->bench_case->is_serial) is_turn_free_ = true;
    const bool has_serial = is_turn_free_ && !serial_.empty();
    if (is_over() || (!has_serial && parallel_.empty())) return {};
    // All runs are in one array, so that addresses give their order.
    const bool is_serial = has_serial && (parallel_.empty() || serial_.front() < parallel_.front());
    std::deque<const BenchRun*>& queue = is_serial ? serial_ : parallel_;
    if (is_serial) is_turn_free_ = false;
    const std::size_t most = plan_.is_warm() ? kMostInBatch : 1;
    Batch batch;
    while (batch.size() < most && !queue.empty() &&
           (batch.empty() || queue.front()->loaded == batch.front()->loaded)) {
      batch.push_back(queue.front());
      queue.pop_front();
    }
    return batch;
  }

  void run_batch(const Batch& batch, ProblemCheckers& checkers) {
    std::vector<TimedRun> timed;
    Stopwatch since_check;
    for (const BenchRun* run : batch) {
      if (!may_run(*run)) continue;
      if (plan_.is_warm() && timed.empty()) {
        warm_up(*run);
        since_check = Stopwatch();
      }
      solve_once(*run, timed);
      if (plan_.is_warm() && since_check.elapsed_s() < kLongestUnchecked) continue;
      report(timed, checkers);
    }
    report(timed, checkers);
  }

  [[nodiscard]] bool may_run(const BenchRun& run) {
    const std::lock_guard lock(mutex_);
    return !is_over() && !is_hopeless(run);
  }

  [[nodiscard]] bool is_over() const { return error_ || is_cancelled_; }

  [[nodiscard]] bool is_hopeless(const BenchRun& run) const {
    const auto found = records_.find(name_without_seed(name_of(run)));
    return plan_.hopeless_after > 0 && found != records_.end() && !found->second.is_solved &&
           found->second.runs >= plan_.hopeless_after;
  }

  void remember(RunName name, bool is_solved) {
    Record& record = records_[name_without_seed(std::move(name))];
    ++record.runs;
    record.is_solved |= is_solved;
  }

  [[nodiscard]] Database* memory_of(const BenchRun& run) const {
    const auto found =
        plan_.memories.find({run.bench_case->memory, run.loaded->problem.robot.hash()});
    const bool is_used =
        needs_memory(run.bench_case->settings.sampler) && found != plan_.memories.end();
    return is_used ? found->second.get() : nullptr;
  }

  /// Runs the case with a short limit and drops the result.
  void warm_up(const BenchRun& run) {
    BenchCase bench_case = *run.bench_case;
    bench_case.settings.plan.timeout_s = std::min(bench_case.settings.plan.timeout_s, kWarmUp);
    bench_case.settings.plan.cancel = plan_.cancel;
    static_cast<void>(plan_.solve(run.loaded->problem, memory_of(run), bench_case));
  }

  void solve_once(const BenchRun& run, std::vector<TimedRun>& timed) {
    BenchCase bench_case = *run.bench_case;
    bench_case.settings.plan.seed = run.seed;
    bench_case.settings.plan.cancel = plan_.cancel;
    std::string started = internal::current_time();
    Result<SolveResult> result = plan_.solve(run.loaded->problem, memory_of(run), bench_case);
    if (!result) return stop(result.error());
    // Later runs must not depend on the time that storing takes.
    if (result->remembered.is_queued) (void)memory_of(run)->flush();
    const std::lock_guard lock(mutex_);
    if (result->plan.status == PlanStatus::cancelled) {
      is_cancelled_ = true;
      return;
    }
    const bool is_late = result->plan.planning_time_s > bench_case.settings.plan.timeout_s;
    remember(name_of(run), result->plan.is_solved() && !is_late);
    timed.push_back({&run, std::move(bench_case), *std::move(result), std::move(started)});
  }

  /// Checks the paths and passes on the rows.
  void report(std::vector<TimedRun>& timed, ProblemCheckers& checkers) {
    for (const TimedRun& each : timed) {
      const auto& [run, bench_case, result, started] = each;
      const auto checker = checkers.find(*run->loaded, bench_case.settings.resolution);
      if (!checker) return stop(checker.error());
      BenchmarkRow row = make_row(run->loaded->problem, bench_case.settings, result, **checker,
                                  checkers.verdict_on(each));
      checkers.keep(each, row);
      row.set = run->loaded->set;
      row.setting = bench_case.setting;
      row.settings = bench_case.description;
      row.machine = machine_;
      row.version = version_;
      row.started = started;
      row.is_warm = plan_.is_warm();
      const std::lock_guard lock(mutex_);
      if (error_) return;
      if (const Result<void> taken = on_row_(row, result); !taken) error_ = taken.error();
    }
    timed.clear();
  }

  void stop(const Error& error) {
    const std::lock_guard lock(mutex_);
    error_ = error;
  }

  static constexpr std::size_t kMostInBatch = 16;
  /// Seconds until paths are checked, so that rows do not come too late.
  static constexpr double kLongestUnchecked = 1;

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

bool BenchPlan::is_warm() const {
  return !is_cold && std::none_of(cases.begin(), cases.end(), [](const BenchCase& c) {
    return learns_while_planning(c.settings);
  });
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
    if (row.is_warm != plan.is_warm()) {
      return fail(ErrorCode::invalid,
                  row.is_warm ? "cannot resume: earlier runs were timed warm, without --cold"
                              : "cannot resume: earlier runs were timed cold; add --cold");
    }
    const double timeout_s = same->settings.plan.timeout_s;
    if (row.timeout_s != timeout_s) {
      return fail(ErrorCode::invalid,
                  "cannot resume: an earlier run had a time limit of {} s, not {} s", row.timeout_s,
                  timeout_s);
    }
    // Rows without a version are from before settings were recorded.
    if (!row.version.empty() && row.settings != same->description) {
      return fail(ErrorCode::invalid,
                  "cannot resume: an earlier run had the settings '{}', not '{}'", row.settings,
                  same->description);
    }
  }
  return {};
}

Result<bool> run_bench(BenchPlan& plan, std::span<const BenchmarkRow> done, const OnRow& on_row) {
  const std::vector<BenchRun> runs = missing_runs(plan, done);
  return RunQueue(plan, runs, done, on_row).run();
}

}  // namespace mneme
