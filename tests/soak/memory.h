// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The memory of a robot during a campaign.
#pragma once

#include "mneme/pipeline.h"

#include <memory>
#include <string>

namespace mneme::soak {

/// Two databases: of pairs of obstacles, and of whole paths. Planar arms learn pairs on a miss;
/// other robots learn them from what they have solved.
class Memory {
 public:
  [[nodiscard]] static Result<Memory> create(const Robot& robot, const std::string& directory);

  /// The database for the plan with this number: they take turns.
  [[nodiscard]] Database& database(int plan) { return plan % 2 == 0 ? pairs_ : paths_; }
  /// Keeps a path, until there are enough.
  Result<void> remember(const Problem& problem, const Path& path);

 private:
  Memory(Database pairs, Database paths) : pairs_(std::move(pairs)), paths_(std::move(paths)) {}
  Database pairs_;
  Database paths_;
};

}  // namespace mneme::soak
