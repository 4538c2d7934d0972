// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "learning/run.h"

#include "base/threads.h"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <utility>

namespace mneme::internal {
namespace {

/// Results are saved after this time or this number: a transaction costs milliseconds and blocks
/// other processes at a server, but a killed process loses unsaved results.
constexpr double kSaveAfter_s = 0.5;
constexpr std::size_t kTasksPerTransaction = 32;
/// Poll interval for expired leases of an idle process.
constexpr double kLongestPoll_s = 1;

class Run {
 public:
  Run(TaskSource& source, const Tasks& tasks, const LearnRun& run)
      : source_(source),
        tasks_(tasks),
        run_(run),
        thread_count_(static_cast<std::size_t>(std::max(1, run.jobs))),
        open_count_(tasks.requested) {}

  Result<LearnSummary> run() {
    const Result<void> served = serve_threads();
    if (!served || is_set(run_.cancel)) leave();
    if (!served) return tl::unexpected(served.error());
    summary_.is_cancelled = is_set(run_.cancel);
    summary_.skipped = tasks_.requested - open_count_ - summary_.learned -
                       static_cast<std::int64_t>(summary_.unsolved.size());
    summary_.time_s = stopwatch_.elapsed_s();
    return std::move(summary_);
  }

 private:
  /// Ends the threads however serve() ends.
  class Stop {
   public:
    explicit Stop(Run& run) : run_(run) {}
    ~Stop() {
      const std::lock_guard lock(run_.mutex_);
      run_.is_stopped_ = true;
      run_.has_tasks_.notify_all();
    }
    Stop(const Stop&) = delete;
    Stop& operator=(const Stop&) = delete;

   private:
    Run& run_;
  };

  Result<void> serve_threads() {
    const Threads threads(thread_count_, [this] { work(); });
    if (threads.size() == 0) return fail(ErrorCode::io, "cannot learn: no thread could be started");
    thread_count_ = threads.size();
    const Stop stop(*this);  // before the threads are joined
    return serve();
  }

  /// Body of a thread. collect() rethrows its exception.
  void work() {
    try {
      learn();
    } catch (...) {
      const std::lock_guard lock(mutex_);
      thrown_ = std::current_exception();
      has_news_.notify_one();
    }
  }

  /// Runs tasks until the end.
  void learn() {
    std::unique_lock lock(mutex_);
    for (;;) {
      has_tasks_.wait(lock, [this] { return is_stopped_ || !ready_.empty(); });
      if (is_stopped_) return;
      const std::size_t task = ready_.front();
      ready_.pop_front();
      lock.unlock();
      auto learned = tasks_.learn(task);
      // A cancelled lesson is incomplete; drop it.
      if (is_set(run_.cancel)) return;
      lock.lock();
      finished_.emplace_back(task, std::move(learned));
      has_news_.notify_one();
    }
  }

  /// Exchanges tasks and results with the source until all are done.
  Result<void> serve() {
    double sound_s = stopwatch_.elapsed_s();
    while (!is_set(run_.cancel)) {
      const Result<bool> is_done = serve_once();
      if (is_done && *is_done) return {};
      const double now_s = stopwatch_.elapsed_s();
      if (is_done) {
        sound_s = now_s;
      } else if (is_done.error().code != ErrorCode::io || now_s - sound_s >= source_.patience_s()) {
        return tl::unexpected(is_done.error());
      }
      MNEME_TRY(collect(std::chrono::milliseconds(50)));
    }
    return {};
  }

  Result<bool> serve_once() {
    MNEME_TRY(source_.renew());
    if (is_time_to_save()) MNEME_TRY(save());
    MNEME_TRY(take());
    MNEME_TRY(count_and_report());
    if (in_work_ > 0 || !unsaved_.empty() || open_count_ > 0) return false;
    MNEME_TRY(source_.refresh());
    return true;
  }

  [[nodiscard]] bool is_time_to_save() const {
    return unsaved_.size() >= kTasksPerTransaction ||
           (!unsaved_.empty() &&
            (in_work_ == 0 || stopwatch_.elapsed_s() - saved_s_ >= kSaveAfter_s));
  }

  Result<void> save() {
    MNEME_TRY(source_.save(unsaved_, summary_));
    saved_s_ = stopwatch_.elapsed_s();
    is_count_due_ = in_work_ == 0;
    return {};
  }

  /// Keeps one spare task per thread, so that none waits for the source.
  Result<void> take() {
    if (in_work_ > thread_count_ || stopwatch_.elapsed_s() < next_take_s_) return {};
    const auto taken = MNEME_TRY(source_.take(2 * thread_count_ - in_work_));
    if (taken.empty()) {
      next_take_s_ = stopwatch_.elapsed_s() + std::min(kLongestPoll_s, source_.patience_s() / 3);
      is_count_due_ = true;
    }
    in_work_ += taken.size();
    const std::lock_guard lock(mutex_);
    ready_.insert(ready_.end(), taken.begin(), taken.end());
    has_tasks_.notify_all();
    return {};
  }

  /// Counts open tasks when there may be none left or a progress report is due.
  Result<void> count_and_report() {
    const double begin_s = stopwatch_.elapsed_s();
    const bool is_report_due = run_.on_progress && begin_s >= next_report_s_;
    if (!is_count_due_ && !is_report_due) return {};
    open_count_ = MNEME_TRY(source_.count_open());
    is_count_due_ = false;
    if (!is_report_due && open_count_ > 0) return {};
    // Counting a million tasks loads a server, so reports become rarer.
    const double now_s = stopwatch_.elapsed_s();
    next_report_s_ = now_s + std::max(1.0, 20 * (now_s - begin_s));
    report();
    return {};
  }

  void report() const {
    if (!run_.on_progress) return;
    run_.on_progress({tasks_.requested - open_count_, tasks_.requested, summary_.components,
                      stopwatch_.elapsed_s()});
  }

  /// Waits for results.
  Result<void> collect(std::chrono::milliseconds patience) {
    std::unique_lock lock(mutex_);
    has_news_.wait_for(lock, patience, [this] { return !finished_.empty() || thrown_; });
    if (thrown_) std::rethrow_exception(thrown_);
    for (auto& [task, learned] : std::exchange(finished_, {})) {
      if (!learned) return tl::unexpected(learned.error());
      unsaved_.emplace(task, std::move(*learned));
      --in_work_;
    }
    return {};
  }

  /// Saves finished results and returns other tasks, as far as possible.
  void leave() {
    (void)collect({});
    if (!unsaved_.empty()) (void)save();
    source_.release();
    if (!is_set(run_.cancel)) return;
    open_count_ = source_.count_open().value_or(open_count_);
    report();
    // The first call may only detect a lost connection.
    if (!source_.refresh()) (void)source_.refresh();
  }

  Stopwatch stopwatch_;
  TaskSource& source_;
  const Tasks& tasks_;
  const LearnRun& run_;

  // Used by the serving thread only.
  std::size_t thread_count_;
  LearnSummary summary_;
  std::size_t in_work_ = 0;  ///< taken, and no result yet
  Results unsaved_;
  std::int64_t open_count_;
  bool is_count_due_ = false;
  double saved_s_ = 0;
  double next_take_s_ = 0;
  double next_report_s_ = 1;

  std::mutex mutex_;
  std::condition_variable has_tasks_;
  std::condition_variable has_news_;
  std::deque<std::size_t> ready_;
  std::vector<std::pair<std::size_t, Result<Learned>>> finished_;
  std::exception_ptr thrown_;
  bool is_stopped_ = false;
};

/// Inserts in the order of the tasks, so that the database does not depend on the threads.
class LocalSource final : public TaskSource {
 public:
  LocalSource(Database& database, const std::vector<std::size_t>& tasks)
      : database_(database), tasks_(tasks), ready_(tasks) {}

  /// All tasks: there are no other processes.
  Result<std::vector<std::size_t>> take(std::size_t) override { return std::exchange(ready_, {}); }

  Result<void> save(Results& results, LearnSummary& summary) override {
    std::vector<Experience> rows;
    auto end = results.begin();
    std::size_t saved = saved_;
    for (; end != results.end() && end->first == tasks_[saved]; ++end, ++saved) {
      rows.insert(rows.end(), end->second.rows.begin(), end->second.rows.end());
    }
    std::vector<bool> is_new;
    if (!rows.empty()) MNEME_TRY(database_.insert(std::move(rows), &is_new));
    auto first = is_new.cbegin();
    for (auto done = results.begin(); done != end; ++done) {
      count(done->second, first, summary);
      first += std::ssize(done->second.rows);
    }
    results.erase(results.begin(), end);
    saved_ = saved;
    return {};
  }

  Result<std::int64_t> count_open() override {
    return static_cast<std::int64_t>(tasks_.size() - saved_);
  }

 private:
  Database& database_;
  const std::vector<std::size_t>& tasks_;
  std::vector<std::size_t> ready_;
  std::size_t saved_ = 0;
};

}  // namespace

void count(const Learned& learned, std::vector<bool>::const_iterator is_new,
           LearnSummary& summary) {
  if (!learned.failure.empty()) {
    summary.unsolved.push_back(learned.failure);
    return;
  }
  ++summary.learned;
  std::int64_t components = 0;
  for (const Experience& row : learned.rows) {
    components += row.component_count();
    if (!*is_new++) continue;
    ++summary.rows;
    summary.components += row.component_count();
  }
  if (components == 0) ++summary.empty;
}

Result<LearnSummary> run_tasks(TaskSource& source, const Tasks& tasks, const LearnRun& run) {
  return Run(source, tasks, run).run();
}

Result<LearnSummary> run_local(Database& database, const Tasks& tasks, const LearnRun& run) {
  LocalSource source(database, tasks.open);
  return run_tasks(source, tasks, run);
}

}  // namespace mneme::internal
