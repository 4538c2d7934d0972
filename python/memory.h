// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What the memory is to Python: shared, so that results may outlive the object that opened it.
#pragma once

#include "mneme/memory.h"
#include "mneme/pipeline.h"

#include "errors.h"

#include <filesystem>
#include <memory>
#include <string>

namespace mneme::python {

class Memory {
 public:
  explicit Memory(Database database) : database_(std::make_shared<Database>(std::move(database))) {}

  /// The open database; a mneme.Error if it was closed.
  [[nodiscard]] std::shared_ptr<Database> get() const {
    if (!database_) raise_invalid("the database was closed");
    return database_;
  }
  void close() { database_.reset(); }
  /// The kind to learn: the one that is asked for, or else that of the rows, or else the robot's.
  [[nodiscard]] MemorySettings to_learn(MemorySettings asked) const {
    const std::vector<KindInfo> kinds = get()->kinds();
    if (asked.kind || kinds.empty()) return asked;
    if (const MemoryKind* kind = memory_kind_of(kinds.front().kind)) asked.kind = kind->name;
    return asked;
  }

 private:
  std::shared_ptr<Database> database_;
};

/// What is asked of a memory is asked in vain without one.
inline void check_without_memory(const SolveSettings& settings) {
  if (settings.learn_budget_s > 0) {
    raise_invalid("plan: learn_budget needs a database, where it puts what is learned");
  }
  if (settings.remember_after) {
    raise_invalid("plan: remember_after needs a database, where it puts what is remembered");
  }
  if (settings.replay > 0) raise_invalid("plan: replay needs a database, whose paths it replays");
}

}  // namespace mneme::python
