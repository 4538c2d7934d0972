// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Tasks that several processes share through a database's server.
#pragma once

#include "mneme/store.h"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace mneme::internal {

/// The right to finish a task, as long as nobody was given a later attempt at it.
struct Lease {
  std::int64_t task = 0;
  std::int64_t attempt = 0;  ///< from 1

  bool operator==(const Lease&) const = default;
};

/// The tasks of one job. The server's clock decides what has expired. Not thread-safe; a connection
/// that was lost is made again by the next call. Errors of all calls: io, corrupt.
class TaskQueue {
 public:
  virtual ~TaskQueue() = default;

  /// Makes tasks known. One that was done before opens again if it was done up to `generation` of
  /// the database: whoever adds it has not found its result there.
  [[nodiscard]] virtual Result<void> add(std::span<const std::int64_t> tasks,
                                         std::int64_t generation) = 0;
  /// Takes up to `count` tasks that are neither done nor leased, or whose lease has expired, for
  /// `seconds`: the first ones first.
  [[nodiscard]] virtual Result<std::vector<Lease>> take(int count, double seconds) = 0;
  /// The heartbeat: leases last `seconds` from now on. Returns those that are still good, also if
  /// they had expired and nobody noticed.
  [[nodiscard]] virtual Result<std::vector<Lease>> renew(std::span<const Lease> leases,
                                                         double seconds) = 0;
  /// Gives tasks back at once.
  [[nodiscard]] virtual Result<void> release(std::span<const Lease> leases) = 0;
  /// Inserts the rows of the leases that are still good and marks their tasks as done, in one
  /// transaction. `rows` has one per lease. Returns those leases. Whoever does not know whether it
  /// succeeded may do it again. Errors also: invalid, as of Database::insert().
  [[nodiscard]] virtual Result<std::vector<Lease>> finish(std::span<const Lease> leases,
                                                          std::vector<Experience> rows) = 0;
  /// Tasks that are not done.
  [[nodiscard]] virtual Result<std::int64_t> count_open() = 0;
};

/// Which job, and for the eyes of an administrator who works on it.
struct TaskOwner {
  std::int64_t job = 0;
  std::string worker;
};

}  // namespace mneme::internal
