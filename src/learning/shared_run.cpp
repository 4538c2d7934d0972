// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "learning/shared_run.h"

#include "base/stopwatch.h"
#include "store/open_store.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <set>
#include <thread>

namespace mneme::internal {
namespace {

/// What is learned goes to the server after this time, or when there is this much of it: the
/// processes take turns there, and one that is killed loses what it holds.
constexpr double kPatience_s = 0.5;
constexpr std::size_t kRowsPerTransaction = 32;
/// How often a process that has nothing to do looks whether somebody's lease has expired.
constexpr double kLongestPoll_s = 1;

std::string worker_name() {
  std::array<char, 256> host{};
  ::gethostname(host.data(), host.size() - 1);
  return std::string(host.data()) + ":" + std::to_string(::getpid());
}

class SharedRun {
 public:
  SharedRun(const Robot& robot, std::span<const Lesson> lessons, Database& database,
            const LearnJob& job)
      : robot_(robot), database_(database), job_(job), settings_text_(describe(job.settings)) {
    std::set<std::uint64_t> seen;
    for (const Lesson& lesson : lessons) {
      const std::uint64_t seed = lesson_seed(job.seed, *lesson.key);
      if (seen.insert(seed).second) tasks_.push_back({lesson, seed});
    }
    lesson_count_ = static_cast<std::int64_t>(lessons.size());
    open_count_ = static_cast<std::int64_t>(tasks_.size());
  }

  Result<LearnSummary> run() {
    const auto joined = join();
    if (!joined) return tl::unexpected(joined.error());
    std::vector<std::jthread> threads;
    for (int i = 0; i < std::max(1, job_.jobs); ++i) threads.emplace_back([this] { work(); });
    const auto served = serve();
    stop();
    threads.clear();
    leave();
    if (!served) return tl::unexpected(served.error());
    const auto refreshed = refresh();
    if (!refreshed) return tl::unexpected(refreshed.error());
    summary_.is_cancelled = is_cancelled(job_);
    summary_.skipped = lesson_count_ - open_count_ - summary_.learned;
    summary_.time_s = stopwatch_.elapsed_s();
    return summary_;
  }

 private:
  struct Task {
    Lesson lesson;
    std::uint64_t seed = 0;
  };
  struct Finished {
    Lease lease;
    Result<LearnResult> result;
  };

  /// The same for all processes with the same settings, seed and primitives.
  [[nodiscard]] std::int64_t job_number() const {
    std::vector<std::int64_t> numbers = {hash_bytes(std::as_bytes(std::span(settings_text_)))};
    for (const Task& task : tasks_) numbers.push_back(static_cast<std::int64_t>(task.seed));
    return hash_numbers(numbers);
  }

  /// Makes the tasks known that are not in the database.
  Result<void> join() {
    const double lease_s = job_.shared->lease_s;
    if (!(lease_s >= 0.1 && lease_s <= 86400)) {
      return fail(ErrorCode::invalid, "a lease must last 0.1 to 86400 seconds");
    }
    auto queue =
        open_tasks(job_.shared->url, database_.space(), TaskOwner{job_number(), worker_name()});
    if (!queue) return tl::unexpected(queue.error());
    queue_ = std::move(*queue);
    const std::int64_t generation = database_.info().generation;
    const auto known = learned_seeds(database_, settings_text_);
    if (!known) return tl::unexpected(known.error());
    std::vector<std::int64_t> missing;
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      if (!known->contains(tasks_[i].seed)) missing.push_back(static_cast<std::int64_t>(i));
    }
    return queue_->add(missing, generation);
  }

  /// A thread that learns what was taken.
  void work() {
    for (;;) {
      std::unique_lock lock(mutex_);
      has_tasks_.wait(lock, [this] { return is_over_ || !ready_.empty(); });
      if (is_over_) return;
      const Lease lease = ready_.front();
      ready_.pop_front();
      lock.unlock();
      const Task& task = tasks_[static_cast<std::size_t>(lease.task)];
      auto learned = learn(robot_, task.lesson, job_, task.seed);
      // What a cancellation cut short is not what the arguments say.
      if (is_cancelled(job_)) return;
      lock.lock();
      finished_.push_back({lease, std::move(learned)});
      has_news_.notify_one();
    }
  }

  /// Speaks with the server until all is done. An error of it is borne for as long as a lease.
  Result<void> serve() {
    double sound_s = stopwatch_.elapsed_s();
    while (!is_cancelled(job_)) {
      wait_for_news();
      const Result<bool> is_done = serve_once();
      if (is_done && *is_done) return {};
      const double now_s = stopwatch_.elapsed_s();
      if (is_done) {
        sound_s = now_s;
      } else if (is_done.error().code != ErrorCode::io || now_s - sound_s > job_.shared->lease_s) {
        return tl::unexpected(is_done.error());
      }
    }
    return {};
  }

  void wait_for_news() {
    std::unique_lock lock(mutex_);
    has_news_.wait_for(lock, std::chrono::milliseconds(50), [this] { return !finished_.empty(); });
    for (; !finished_.empty(); finished_.pop_front()) {
      unsaved_.push_back(std::move(finished_.front()));
    }
  }

  Result<bool> serve_once() {
    return renew()
        .and_then([&] { return is_time_to_save() ? save() : Result<void>(); })
        .and_then([&] { return take(); })
        .and_then([&] { return look_around(); })
        .map([&] { return held_.empty() && open_count_ == 0; });
  }

  Result<void> renew() {
    const double lease_s = job_.shared->lease_s;
    if (held_.empty() || stopwatch_.elapsed_s() - renewed_s_ < lease_s / 3) return {};
    const auto good = queue_->renew(held_, lease_s);
    if (!good) return tl::unexpected(good.error());
    renewed_s_ = stopwatch_.elapsed_s();
    held_ = *good;
    // A task that somebody else has by now need not be begun.
    const std::lock_guard lock(mutex_);
    std::erase_if(ready_, [&](const Lease& lease) { return !std::ranges::count(held_, lease); });
    return {};
  }

  [[nodiscard]] bool is_time_to_save() const {
    return unsaved_.size() >= kRowsPerTransaction ||
           (!unsaved_.empty() &&
            (unsaved_.size() >= held_.size() || stopwatch_.elapsed_s() - saved_s_ >= kPatience_s));
  }

  Result<void> save() {
    std::vector<Lease> leases;
    std::vector<Experience> rows;
    for (const Finished& finished : unsaved_) {
      if (!finished.result) return tl::unexpected(finished.result.error());
      const Task& task = tasks_[static_cast<std::size_t>(finished.lease.task)];
      leases.push_back(finished.lease);
      rows.push_back(make_row(task.lesson, finished.result->sampler, settings_text_, task.seed));
    }
    const auto good = queue_->finish(leases, rows);
    if (!good) return tl::unexpected(good.error());
    for (std::size_t i = 0; i < leases.size(); ++i) {
      if (std::ranges::count(*good, leases[i])) count(rows[i], summary_);
      std::erase(held_, leases[i]);
    }
    unsaved_.clear();
    is_count_due_ = held_.empty();
    saved_s_ = stopwatch_.elapsed_s();
    return {};
  }

  /// Keeps one task in hand for every thread, so that none waits for the server.
  Result<void> take() {
    const auto threads = static_cast<std::size_t>(std::max(1, job_.jobs));
    const std::size_t in_work = held_.size() - std::min(held_.size(), unsaved_.size());
    if (in_work > threads || stopwatch_.elapsed_s() < next_take_s_) return {};
    const double lease_s = job_.shared->lease_s;
    const auto taken = queue_->take(static_cast<int>(2 * threads - in_work), lease_s);
    if (!taken) return tl::unexpected(taken.error());
    if (taken->empty()) {
      next_take_s_ = stopwatch_.elapsed_s() + std::min(kLongestPoll_s, lease_s / 3);
      is_count_due_ = true;
    }
    if (held_.empty()) renewed_s_ = stopwatch_.elapsed_s();
    held_.insert(held_.end(), taken->begin(), taken->end());
    const std::lock_guard lock(mutex_);
    ready_.insert(ready_.end(), taken->begin(), taken->end());
    has_tasks_.notify_all();
    return {};
  }

  /// Counts what is left when there may be nothing left, and for whoever watches.
  Result<void> look_around() {
    const bool is_report_due = job_.on_progress && stopwatch_.elapsed_s() >= next_report_s_;
    if (!is_count_due_ && !is_report_due) return {};
    const double begin_s = stopwatch_.elapsed_s();
    const auto open = queue_->count_open();
    if (!open) return tl::unexpected(open.error());
    open_count_ = *open;
    is_count_due_ = false;
    if (!is_report_due && open_count_ > 0) return {};
    // Counting a million tasks is work for the server, which others need.
    const double now_s = stopwatch_.elapsed_s();
    next_report_s_ = now_s + std::max(1.0, 20 * (now_s - begin_s));
    if (!job_.on_progress) return {};
    job_.on_progress(
        {lesson_count_ - open_count_, lesson_count_, summary_.components, stopwatch_.elapsed_s()});
    return {};
  }

  void stop() {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
    has_tasks_.notify_all();
  }

  /// Saves what is learned, and gives back what is not. If that fails, the leases expire.
  void leave() {
    for (; !finished_.empty(); finished_.pop_front()) {
      unsaved_.push_back(std::move(finished_.front()));
    }
    if (!unsaved_.empty()) (void)save();
    if (!held_.empty()) (void)queue_->release(held_);
    open_count_ = queue_->count_open().value_or(open_count_);
  }

  /// Shows the database what the server has. An error is borne for as long as a lease here too; who
  /// was cancelled tries twice, because the first call only notices a connection that was lost.
  Result<void> refresh() {
    const Stopwatch waited;
    for (bool is_first = true;; is_first = false) {
      const auto refreshed = database_.refresh();
      if (refreshed) return {};
      const bool is_patient =
          is_first || (!is_cancelled(job_) && waited.elapsed_s() <= job_.shared->lease_s);
      if (refreshed.error().code != ErrorCode::io || !is_patient) {
        return tl::unexpected(refreshed.error());
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }

  Stopwatch stopwatch_;
  const Robot& robot_;
  Database& database_;
  const LearnJob& job_;
  std::string settings_text_;
  std::vector<Task> tasks_;
  std::int64_t lesson_count_ = 0;
  LearnSummary summary_;

  // Of the thread that serves.
  std::unique_ptr<TaskQueue> queue_;
  std::vector<Lease> held_;  // not yet saved: ready, in work, or learned
  std::deque<Finished> unsaved_;
  std::int64_t open_count_ = 0;
  bool is_count_due_ = false;
  double renewed_s_ = 0;
  double saved_s_ = 0;
  double next_take_s_ = 0;
  double next_report_s_ = 1;

  std::mutex mutex_;
  std::condition_variable has_tasks_;
  std::condition_variable has_news_;
  std::deque<Lease> ready_;
  std::deque<Finished> finished_;
  bool is_over_ = false;
};

}  // namespace

Result<LearnSummary> learn_shared(const Robot& robot, std::span<const Lesson> lessons,
                                  Database& database, const LearnJob& job) {
  return SharedRun(robot, lessons, database, job).run();
}

}  // namespace mneme::internal
