// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What the memory is to Python: shared, so that results may outlive the object that opened it.
#pragma once

#include "mneme/experience.h"

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

 private:
  std::shared_ptr<Database> database_;
};

}  // namespace mneme::python
