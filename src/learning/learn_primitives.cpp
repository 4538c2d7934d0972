// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <condition_variable>
#include <map>
#include <mutex>
#include <set>
#include <thread>

#include "learning/lesson.h"
#include "learning/shared_run.h"
#include "mneme/learning.h"

namespace mneme {
namespace {

using internal::Lesson;

/// Rows that wait for one transaction, which costs a few milliseconds, and how long they wait: a
/// killed job loses at most these, and what waits for an earlier primitive.
constexpr std::size_t kRowsPerTransaction = 32;
constexpr double kPatience_s = 1;

class LearnRun {
 public:
  LearnRun(const Robot& robot, std::span<const Lesson> lessons, Database& database,
           const LearnJob& job)
      : robot_(robot),
        lessons_(lessons),
        database_(database),
        job_(job),
        settings_text_(describe(job.settings)) {}

  Result<LearnSummary> run() {
    if (const auto chosen = choose_tasks(); !chosen) return tl::unexpected(chosen.error());
    std::vector<std::jthread> workers;
    for (int i = 0; i < std::max(1, job_.jobs); ++i) workers.emplace_back([this] { work(); });
    store_results();
    workers.clear();
    if (error_) return tl::unexpected(*error_);
    summary_.is_cancelled = internal::is_cancelled(job_);
    summary_.time_s = stopwatch_.elapsed_s();
    return summary_;
  }

 private:
  struct Task {
    Lesson lesson;
    std::uint64_t seed = 0;
  };

  /// Leaves out what was learned before.
  Result<void> choose_tasks() {
    auto known = internal::learned_seeds(database_, settings_text_);
    if (!known) return tl::unexpected(known.error());
    for (const Lesson& lesson : lessons_) {
      const std::uint64_t seed = internal::lesson_seed(job_.seed, *lesson.key);
      if (known->insert(seed).second) tasks_.push_back({lesson, seed});
    }
    summary_.skipped = static_cast<std::int64_t>(lessons_.size() - tasks_.size());
    return {};
  }

  void work() {
    for (;;) {
      const std::size_t task = next_task_.fetch_add(1);
      if (task >= tasks_.size() || has_failed_.load() || internal::is_cancelled(job_)) return;
      auto learned = internal::learn(robot_, tasks_[task].lesson, job_, tasks_[task].seed);
      // What a cancellation cut short is not what the arguments say.
      if (internal::is_cancelled(job_)) return;
      const std::lock_guard lock(mutex_);
      finished_.emplace(task, std::move(learned));
      is_finished_.notify_one();
    }
  }

  /// Inserts results in the order of the keys, so that the file does not depend on the threads.
  void store_results() {
    double last_progress_s = 0;
    for (std::size_t task = 0; task < tasks_.size() && !has_failed_.load(); ++task) {
      auto learned = wait_for(task);
      if (!learned) break;
      if (!*learned) return stop_with(learned->error());
      rows_.push_back(internal::make_row(tasks_[task].lesson, std::move((*learned)->sampler),
                                         settings_text_, tasks_[task].seed));
      internal::count(rows_.back(), summary_);
      if (is_time_to_insert() && !insert()) return;
      if (job_.on_progress && stopwatch_.elapsed_s() - last_progress_s >= 1) {
        last_progress_s = stopwatch_.elapsed_s();
        report_progress();
      }
    }
    if (!has_failed_.load() && insert() && job_.on_progress) report_progress();
  }

  [[nodiscard]] bool is_time_to_insert() const {
    return rows_.size() >= kRowsPerTransaction ||
           (!rows_.empty() && stopwatch_.elapsed_s() - inserted_s_ >= kPatience_s);
  }

  /// The result of `task`, or nothing if the job was cancelled before it or rows cannot be stored.
  std::optional<Result<LearnResult>> wait_for(std::size_t task) {
    std::unique_lock lock(mutex_);
    while (!finished_.contains(task)) {
      if (internal::is_cancelled(job_)) return std::nullopt;
      if (is_time_to_insert()) {
        lock.unlock();
        if (!insert()) return std::nullopt;
        lock.lock();
        continue;
      }
      is_finished_.wait_for(lock, std::chrono::milliseconds(50));
    }
    auto node = finished_.extract(task);
    return std::move(node.mapped());
  }

  bool insert() {
    if (rows_.empty()) return true;
    auto inserted = database_.insert(std::exchange(rows_, {}));
    inserted_s_ = stopwatch_.elapsed_s();
    if (!inserted) stop_with(inserted.error());
    return inserted.has_value();
  }

  void stop_with(Error error) {
    error_ = std::move(error);
    has_failed_.store(true);
  }

  void report_progress() const {
    const auto total = static_cast<std::int64_t>(tasks_.size()) + summary_.skipped;
    job_.on_progress(
        {summary_.learned + summary_.skipped, total, summary_.components, stopwatch_.elapsed_s()});
  }

  Stopwatch stopwatch_;
  const Robot& robot_;
  std::span<const Lesson> lessons_;
  Database& database_;
  const LearnJob& job_;
  std::string settings_text_;
  std::vector<Task> tasks_;
  std::atomic<std::size_t> next_task_ = 0;
  std::atomic<bool> has_failed_ = false;
  std::mutex mutex_;
  std::condition_variable is_finished_;
  std::map<std::size_t, Result<LearnResult>> finished_;
  // Of the thread that stores results.
  std::vector<Experience> rows_;
  double inserted_s_ = 0;
  std::optional<Error> error_;
  LearnSummary summary_;
};

Result<LearnSummary> run(const Robot& robot, std::span<const Lesson> lessons, Database& database,
                         const LearnJob& job) {
  if (job.shared) return internal::learn_shared(robot, lessons, database, job);
  return LearnRun(robot, lessons, database, job).run();
}

}  // namespace

Result<LearnSummary> learn_primitives(const Robot& robot, std::span<const PrimitiveKey> keys,
                                      Database& database, const LearnJob& job) {
  std::vector<Lesson> lessons;
  for (const PrimitiveKey& key : keys) lessons.push_back({&key, nullptr});
  return run(robot, lessons, database, job);
}

Result<LearnSummary> learn_primitives(const Robot& robot, std::span<const LocalProblem> problems,
                                      Database& database, const LearnJob& job) {
  std::vector<Lesson> lessons;
  for (const LocalProblem& problem : problems) {
    lessons.push_back({&problem.primitive.key, &problem});
  }
  return run(robot, lessons, database, job);
}

}  // namespace mneme
