// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The kernel that proves families of motions free, one box of time and parameters per lane.
#pragma once

#include "mneme/collision.h"

#include "tables/tables.h"

#include <span>

namespace mneme::internal {

/// Distances in metres that a family keeps.
struct FamilyMargins {
  float obstacles = 0, links = 0;
  /// Boxes in which a body may move farther are not free.
  float most_displacement = 0;
  bool has_links = true;  ///< false: links do not count against each other
};

/// CollisionChecker::check_family().
using FamilyKernel = void (*)(const RobotTables& robot, const SceneTables& scene,
                              const FamilyMotion& motion, std::span<const FamilyBox> boxes,
                              const FamilyMargins& margins, std::span<FamilyVerdict> verdicts);

/// The kernel of an instruction set that this machine has.
[[nodiscard]] FamilyKernel family_kernel(Isa isa);

}  // namespace mneme::internal
