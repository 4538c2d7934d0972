// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Choices of solved tasks as rows of the database, found by the object and where it was.
#pragma once

#include "task/alternatives.h"

#include <string>
#include <vector>

namespace mneme::internal {

/// Rows that rank the alternatives of one query.
class TaskMemory {
 public:
  /// Finds the rows for the object that the task attaches first. A null database, or one that
  /// cannot be read, has none: choices are a hint.
  TaskMemory(const Task& task, const std::vector<Group>& groups, Database* database);

  [[nodiscard]] int rows() const { return static_cast<int>(rows_.size()); }
  /// Ranks the targets of group number `group`: those nearest to a remembered choice first.
  [[nodiscard]] Remembered rank(std::size_t group, const World& world,
                                const std::vector<Transform>& targets, std::size_t first,
                                const std::string& link) const;

  /// Queues the anchors of a plan, one configuration per group, to be stored. Returns false if
  /// there is no database or no object. Errors: as of Database::insert_later().
  [[nodiscard]] Result<bool> remember(const std::vector<Configuration>& anchors,
                                      const std::string& name) const;

 private:
  struct Row {
    Transform X_WO;
    std::vector<Configuration> anchors;
  };
  [[nodiscard]] std::vector<double> key() const;

  const Task& task_;
  Database* database_;
  std::string object_;
  Transform X_WO_;
  std::size_t groups_;
  std::vector<Row> rows_;
};

}  // namespace mneme::internal
