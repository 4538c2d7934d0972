// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme.Database: shared with the calls that use it, which may end after it was closed.
#pragma once

#include "mneme/benchmark.h"
#include "mneme/memory.h"
#include "mneme/pipeline.h"

#include "errors.h"
#include "interruptible.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace mneme::python {

class Memory {
 public:
  explicit Memory(Database database)
      : database_(new Database(std::move(database)), &Memory::destroy) {}

  /// Returns the open database. Raises mneme.Error if it was closed.
  [[nodiscard]] std::shared_ptr<Database> get() const {
    if (!database_) raise_invalid("the database was closed");
    return database_;
  }
  [[nodiscard]] bool is_closed() const { return database_ == nullptr; }
  /// Waits for queued rows, without the interpreter lock. Ends at Control-C.
  [[nodiscard]] static Result<void> flush(Database& database, double timeout_s) {
    constexpr double kStep_s = 0.02;
    std::atomic<bool> cancel = false;
    return run_interruptible(cancel, [&] {
      const Stopwatch stopwatch;
      for (;;) {
        const double left_s = timeout_s - stopwatch.elapsed_s();
        auto flushed = database.flush(std::clamp(left_s, 0.0, kStep_s));
        if (flushed || left_s <= kStep_s || cancel) return flushed;
      }
    });
  }
  /// Stores queued rows and closes the file, also if rows could not be stored: raises mneme.Error
  /// then. Control-C gives them up, with a warning.
  void close() {
    if (is_closed()) return;
    constexpr double kLongest_s = 30;
    const std::shared_ptr<Database> database = std::exchange(database_, nullptr);
    Result<void> stored;
    try {
      stored = flush(*database, kLongest_s);
    } catch (const py::error_already_set&) {
      database->stop_waiting();
      const std::int64_t waiting = database->queued_rows().waiting;
      if (waiting > 0) warn(fmt::format("{}: {} rows are lost", database->info().url, waiting));
      throw;
    }
    if (stored) return;
    database->stop_waiting();
    stored.error().message += "; they are lost, because the database was closed";
    unwrap(std::move(stored));
  }
  /// Completes the kind to learn: the requested one, the kind of the rows or the robot's default,
  /// in this order.
  [[nodiscard]] MemorySettings to_learn(MemorySettings settings) const {
    const std::vector<KindInfo> kinds = get()->kinds();
    if (settings.kind || kinds.empty()) return settings;
    if (const MemoryKind* kind = memory_kind_of(kinds.front().kind)) settings.kind = kind->name;
    return settings;
  }

 private:
  /// May wait for rows and locks: other Python threads go on meanwhile.
  static void destroy(Database* database) {
    std::optional<py::gil_scoped_release> released;
    if (PyGILState_Check() != 0) released.emplace();
    delete database;
  }

  std::shared_ptr<Database> database_;
};

/// Raises mneme.Error for settings that need a database, TypeError for such a sampler. `function`:
/// the name of the call in messages.
inline void check_without_memory(const std::string& function, const SolveSettings& settings) {
  if (needs_memory(settings.sampler)) {
    throw py::type_error(fmt::format("{}: the sampler '{}' needs a database to sample from",
                                     function, settings.sampler));
  }
  if (settings.learn_budget_s > 0) {
    raise_invalid(function + ": learn_budget needs a database for the learned rows");
  }
  if (settings.remember_after) {
    raise_invalid(function + ": remember_after needs a database for the remembered rows");
  }
  if (settings.replay > 0)
    raise_invalid(function + ": replay needs a database with paths to replay");
}

}  // namespace mneme::python
