// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What the memory is to Python: shared, so that results may outlive the object that opened it.
#pragma once

#include "mneme/memory.h"

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

}  // namespace mneme::python
