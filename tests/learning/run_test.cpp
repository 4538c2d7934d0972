// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "learning/run.h"
#include "support/no_threads.h"
#include "support/support.h"

#include <atomic>
#include <new>
#include <numeric>
#include <stdexcept>

namespace mneme::test {
namespace {

/// Remembers what is saved, and fails as it is told.
class ScriptedSource final : public internal::TaskSource {
 public:
  explicit ScriptedSource(int tasks) : left_(tasks) {}

  Result<std::vector<std::size_t>> take(std::size_t count) override {
    std::vector<std::size_t> tasks(std::min<std::size_t>(count, left_ - next_));
    std::iota(tasks.begin(), tasks.end(), next_);
    next_ += tasks.size();
    most_taken = std::max(most_taken, next_ - saved.size());
    return tasks;
  }
  Result<void> save(internal::Results& results, LearnSummary& summary) override {
    if (failures-- > 0) return fail(code, "the server is away");
    for (const auto& [task, learned] : std::exchange(results, {})) {
      saved.push_back(task);
      internal::count(learned, std::vector<bool>(learned.rows.size(), true).cbegin(), summary);
    }
    return {};
  }
  Result<std::int64_t> count_open() override {
    return static_cast<std::int64_t>(left_ - saved.size());
  }
  void release() override { is_released = true; }
  [[nodiscard]] double patience_s() const override { return 60; }

  std::vector<std::size_t> saved;
  std::size_t most_taken = 0;
  int failures = 0;
  ErrorCode code = ErrorCode::io;
  bool is_released = false;

 private:
  std::size_t left_;
  std::size_t next_ = 0;
};

internal::Tasks easy_tasks(int count) {
  return {{}, count, [](std::size_t) { return internal::Learned{{Experience()}, {}}; }};
}

LearnRun run_with(int jobs) {
  LearnRun run;
  run.jobs = jobs;
  return run;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("every task is done once, and few are held that others could do") {
    for (const int jobs : {1, 4}) {
      ScriptedSource source(2000);
      const auto summary = require(internal::run_tasks(source, easy_tasks(2000), run_with(jobs)));
      CHECK(summary.learned == 2000);
      CHECK(summary.rows == 2000);
      CHECK(summary.empty == 2000);
      CHECK(summary.skipped == 0);
      CHECK(!source.is_released);
      CHECK(source.most_taken <= 2 * static_cast<std::size_t>(jobs) + 31);
      std::ranges::sort(source.saved);
      CHECK(std::ranges::adjacent_find(source.saved) == source.saved.end());
    }
  }

  TEST_CASE("errors of the server are borne, others end the run and give back what was taken") {
    ScriptedSource away(50);
    away.failures = 3;
    require(internal::run_tasks(away, easy_tasks(50), run_with(2)));
    CHECK(away.saved.size() == 50);

    ScriptedSource broken(50);
    broken.failures = 1;
    broken.code = ErrorCode::corrupt;
    const Error refused = require_error(internal::run_tasks(broken, easy_tasks(50), run_with(2)));
    CHECK(refused.code == ErrorCode::corrupt);
    CHECK(broken.is_released);
  }

  TEST_CASE("a task that cannot be done ends the run, and what was done is saved") {
    ScriptedSource source(100);
    internal::Tasks tasks = easy_tasks(100);
    tasks.learn = [](std::size_t task) -> Result<internal::Learned> {
      if (task == 40) return fail(ErrorCode::io, "no task");
      return internal::Learned{{}, task % 2 == 0 ? "" : "odd"};
    };
    CHECK(require_error(internal::run_tasks(source, tasks, run_with(1))).message == "no task");
    CHECK(source.saved.size() >= 32);
    CHECK(std::ranges::count(source.saved, 40U) == 0);
  }

  TEST_CASE("a run that is cancelled saves what it has") {
    ScriptedSource source(1000000);
    std::atomic<bool> is_cancelled = false;
    internal::Tasks tasks = easy_tasks(1000000);
    tasks.learn = [&](std::size_t task) {
      if (task == 500) is_cancelled = true;
      return internal::Learned{{}, "not solved"};
    };
    LearnRun run = run_with(2);
    run.cancel = &is_cancelled;
    const auto summary = require(internal::run_tasks(source, tasks, run));
    CHECK(summary.is_cancelled);
    CHECK(source.is_released);
    CHECK(summary.learned == 0);
    CHECK(summary.skipped == 0);
    CHECK(summary.unsolved.size() == source.saved.size());
    CHECK(source.saved.size() >= 490);
  }

  TEST_CASE("what whoever watches throws ends the run") {
    ScriptedSource source(10);
    LearnRun run = run_with(2);
    run.on_progress = [](const LearnProgress&) { throw std::runtime_error("enough"); };
    CHECK_THROWS_WITH((void)internal::run_tasks(source, easy_tasks(10), run), "enough");
  }

  TEST_CASE("memory that runs out in a thread ends the run, not the process") {
    for (const int jobs : {1, 3}) {
      ScriptedSource source(10);
      internal::Tasks tasks = easy_tasks(10);
      tasks.learn = [](std::size_t task) -> Result<internal::Learned> {
        if (task == 5) throw std::bad_alloc();
        return internal::Learned{{Experience()}, {}};
      };
      CHECK_THROWS_AS((void)internal::run_tasks(source, tasks, run_with(jobs)), std::bad_alloc);
    }
  }

  TEST_CASE("a run for which there is no thread is an error") {
    const NoThreads none;
    ScriptedSource source(10);
    const Error refused = require_error(internal::run_tasks(source, easy_tasks(10), run_with(2)));
    CHECK(refused.code == ErrorCode::io);
    CHECK(refused.message == "cannot learn: no thread could be started");
    CHECK(source.is_released);
  }
}

}  // namespace mneme::test
