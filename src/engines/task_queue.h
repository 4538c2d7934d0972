// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Tasks that several processes share through a database server.
#pragma once

#include "mneme/store.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace mneme::internal {

/// The right to finish a task; valid until another process gets a later attempt.
struct Lease {
  std::int64_t task = 0;
  std::int64_t attempt = 0;  ///< from 1

  bool operator==(const Lease&) const = default;
};

/// The tasks of one job. The server's clock decides when a lease expires. Not thread-safe. A call
/// after a lost connection reconnects. Errors of all calls: io, corrupt.
class TaskQueue {
 public:
  virtual ~TaskQueue() = default;

  /// Adds tasks. A task done at or before the database's `generation` is reopened, because the
  /// caller did not find its result there.
  [[nodiscard]] virtual Result<void> add(std::span<const std::int64_t> tasks,
                                         std::int64_t generation) = 0;
  /// Leases up to `count` open tasks for `seconds`, lowest numbers first. Open: not done, and
  /// without a lease or with an expired one.
  [[nodiscard]] virtual Result<std::vector<Lease>> take(int count, double seconds) = 0;
  /// Extends leases to `seconds` from now. Returns the valid ones; an expired lease is valid if no
  /// other process took its task.
  [[nodiscard]] virtual Result<std::vector<Lease>> renew(std::span<const Lease> leases,
                                                         double seconds) = 0;
  /// Returns tasks to the queue.
  [[nodiscard]] virtual Result<void> release(std::span<const Lease> leases) = 0;
  /// Inserts the rows of valid leases and marks their tasks as done, in one transaction. `rows` has
  /// one row per lease. Returns the valid leases. Safe to repeat after an unknown outcome. Errors
  /// also: invalid, see Database::insert().
  [[nodiscard]] virtual Result<std::vector<Lease>> finish(std::span<const Lease> leases,
                                                          std::vector<Experience> rows) = 0;
  /// Number of tasks that are not done.
  [[nodiscard]] virtual Result<std::int64_t> count_open() = 0;
};

/// Number of the job, and the worker's name for administrators.
struct TaskOwner {
  std::int64_t job = 0;
  std::string worker;
};

}  // namespace mneme::internal
