// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// One run of learning: a pool of threads, a source of tasks and a sink for their results.
#pragma once

#include "mneme/learning.h"

#include <map>

namespace mneme::internal {

/// Result of one task: rows that are inserted together.
struct Learned {
  std::vector<Experience> rows;
  std::string failure;  ///< reason of a failed task; otherwise empty
};
/// Results by task number.
using Results = std::map<std::size_t, Learned>;

/// The tasks of a run.
struct Tasks {
  std::vector<std::size_t> open;                      ///< numbers of open tasks, ascending
  std::int64_t requested = 0;                         ///< number of requested tasks, open or
                                                      ///< already done
  std::function<Result<Learned>(std::size_t)> learn;  ///< runs one task, on any thread
};

/// Provides tasks and stores results. Called by one thread; may be called again after an error.
class TaskSource {
 public:
  virtual ~TaskSource() = default;
  /// Takes about `count` tasks; none if none are available now.
  [[nodiscard]] virtual Result<std::vector<std::size_t>> take(std::size_t count) = 0;
  /// Renews the leases of taken tasks. Cheap to call often.
  [[nodiscard]] virtual Result<void> renew() { return {}; }
  /// Inserts the results that can be inserted now, removes them from `results` and counts them.
  [[nodiscard]] virtual Result<void> save(Results& results, LearnSummary& summary) = 0;
  /// Number of tasks whose results are not saved.
  [[nodiscard]] virtual Result<std::int64_t> count_open() = 0;
  /// Returns tasks that were taken and not saved.
  virtual void release() {}
  /// Refreshes the database with rows of other processes.
  [[nodiscard]] virtual Result<void> refresh() { return {}; }
  /// Seconds for which errors of code io are retried.
  [[nodiscard]] virtual double patience_s() const { return 0; }
};

/// Counts a saved task and its new rows.
void count(const Learned& learned, std::vector<bool>::const_iterator is_new, LearnSummary& summary);

[[nodiscard]] Result<LearnSummary> run_tasks(TaskSource& source, const Tasks& tasks,
                                             const LearnRun& run);
/// Runs tasks in one process; results are inserted in the order of task numbers.
[[nodiscard]] Result<LearnSummary> run_local(Database& database, const Tasks& tasks,
                                             const LearnRun& run);
/// Runs tasks shared by several processes; each task has one row as its result. `job` is equal for
/// all processes with equal tasks. The open tasks had no results in the database at `generation`.
[[nodiscard]] Result<LearnSummary> run_shared(Database& database, const Tasks& tasks,
                                              const SharedWork& work, std::int64_t job,
                                              std::int64_t generation, const LearnRun& run);

}  // namespace mneme::internal
