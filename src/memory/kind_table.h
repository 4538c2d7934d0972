// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Kinds of memory as a table: lookup by name and version, defaults for a robot.
#pragma once

#include "mneme/memory.h"

namespace mneme::internal {

class KindTable {
 public:
  /// Refers to the kinds. At least one kind must support each robot.
  constexpr explicit KindTable(std::span<const MemoryKind* const> kinds) : kinds_(kinds) {}

  [[nodiscard]] std::span<const MemoryKind* const> kinds() const { return kinds_; }
  [[nodiscard]] Result<const MemoryKind*> find(std::string_view name) const;
  [[nodiscard]] const MemoryKind* of_version(std::string_view version) const;
  /// The kind of highest `rank` among those that support the robot.
  [[nodiscard]] const MemoryKind& best_for(const Robot& robot, int MemoryKind::*rank) const;

 private:
  std::span<const MemoryKind* const> kinds_;
};

}  // namespace mneme::internal
