// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme.Database: shared ownership, so that results may outlive the Python object.
#pragma once

#include "mneme/memory.h"
#include "mneme/pipeline.h"

#include "errors.h"

#include <memory>
#include <string>

namespace mneme::python {

class Memory {
 public:
  explicit Memory(Database database) : database_(std::make_shared<Database>(std::move(database))) {}

  /// Returns the open database. Raises mneme.Error if it was closed.
  [[nodiscard]] std::shared_ptr<Database> get() const {
    if (!database_) raise_invalid("the database was closed");
    return database_;
  }
  void close() { database_.reset(); }
  /// Completes the kind to learn: the requested one, the kind of the rows or the robot's default,
  /// in this order.
  [[nodiscard]] MemorySettings to_learn(MemorySettings settings) const {
    const std::vector<KindInfo> kinds = get()->kinds();
    if (settings.kind || kinds.empty()) return settings;
    if (const MemoryKind* kind = memory_kind_of(kinds.front().kind)) settings.kind = kind->name;
    return settings;
  }

 private:
  std::shared_ptr<Database> database_;
};

/// Raises mneme.Error for settings that need a database. `function`: the name of the call in
/// messages.
inline void check_without_memory(const std::string& function, const SolveSettings& settings) {
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
