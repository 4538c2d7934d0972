// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What the memory is to Python: shared, so that results may outlive the object that opened it.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "mneme/experience.h"
#include "mneme/primitive.h"

#include "errors.h"

namespace mneme::python {

class Memory {
 public:
  /// A `decomposer` is the one that is to be learned with; if it is empty, that of the rows.
  explicit Memory(Database database, std::string decomposer = "")
      : database_(std::make_shared<Database>(std::move(database))),
        decomposer_(std::move(decomposer)) {}

  /// The open database; a mneme.Error if it was closed.
  [[nodiscard]] std::shared_ptr<Database> get() const {
    if (!database_) raise_invalid("the database was closed");
    return database_;
  }
  void close() { database_.reset(); }
  /// The one that was asked for when it was opened, or empty.
  [[nodiscard]] const std::string& asked_decomposer() const { return decomposer_; }
  /// Empty if there are neither rows nor a wish: then it is the robot's own.
  [[nodiscard]] std::string decomposer() const {
    if (!decomposer_.empty()) return decomposer_;
    const std::vector<KindInfo> kinds = get()->kinds();
    return kinds.empty() ? "" : decomposer_of_version(kinds.front().kind).value_or("");
  }

 private:
  std::shared_ptr<Database> database_;
  std::string decomposer_;
};

}  // namespace mneme::python
