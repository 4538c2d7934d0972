// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// One run of learning: a pool of threads, and where its tasks come from and what they teach goes.
#pragma once

#include "mneme/learning.h"

#include <map>

namespace mneme::internal {

/// What one task taught: rows that go into the database together.
struct Learned {
  std::vector<Experience> rows;
  std::string failure;  ///< why it could not be done; empty if it was
};
/// By the numbers of their tasks.
using Results = std::map<std::size_t, Learned>;

/// What a run is to do.
struct Tasks {
  std::vector<std::size_t> open;                      ///< numbers of those to do, ascending
  std::int64_t asked = 0;                             ///< these and others that need not be done
  std::function<Result<Learned>(std::size_t)> learn;  ///< does one, on any thread
};

/// Hands out tasks and takes results in. Called by one thread; may be called again after an error.
class TaskSource {
 public:
  virtual ~TaskSource() = default;
  /// Tasks for threads that could use `count` of them; none if there are none just now.
  [[nodiscard]] virtual Result<std::vector<std::size_t>> take(std::size_t count) = 0;
  /// Keeps what was taken. Cheap to call often.
  [[nodiscard]] virtual Result<void> renew() { return {}; }
  /// Inserts what of `results` can be inserted by now, removes it from there and counts it.
  [[nodiscard]] virtual Result<void> save(Results& results, LearnSummary& summary) = 0;
  /// Tasks that nobody has saved.
  [[nodiscard]] virtual Result<std::int64_t> count_open() = 0;
  /// Gives back what was taken and not saved.
  virtual void release() {}
  /// Shows the database what others have saved.
  [[nodiscard]] virtual Result<void> refresh() { return {}; }
  /// Seconds for which errors of code io are borne.
  [[nodiscard]] virtual double patience_s() const { return 0; }
};

[[nodiscard]] bool is_cancelled(const LearnRun& run);
/// Counts a task that was saved, and of its rows those that are new.
void count(const Learned& learned, std::vector<bool>::const_iterator is_new, LearnSummary& summary);

[[nodiscard]] Result<LearnSummary> run_tasks(TaskSource& source, const Tasks& tasks,
                                             const LearnRun& run);
/// For one process: what is learned is inserted in the order of the tasks' numbers.
[[nodiscard]] Result<LearnSummary> run_local(Database& database, const Tasks& tasks,
                                             const LearnRun& run);
/// For one of several processes that share tasks, each with one row as its result. `job` is the
/// same number for all processes with the same tasks; the results of the open ones were missed in
/// the database's `generation`.
[[nodiscard]] Result<LearnSummary> run_shared(Database& database, const Tasks& tasks,
                                              const SharedWork& work, std::int64_t job,
                                              std::int64_t generation, const LearnRun& run);

}  // namespace mneme::internal
