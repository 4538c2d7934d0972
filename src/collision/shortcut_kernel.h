// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The kernels that rate candidates for shortening a path, sixteen at a time.
#pragma once

#include "mneme/collision.h"

#include "tables/tables.h"

namespace mneme::internal {

struct ShortcutKernels {
  /// CollisionChecker::rate_shortcuts() with the total margin `margin`.
  void (*rate_shortcuts)(const RobotTables& robot, const SceneTables& scene, const PathView& path,
                         float least_gain, float margin,
                         std::span<Shortcut, kShortcuts> shortcuts) = nullptr;
  /// CollisionChecker::rate_relaxations() with the total margin `margin`.
  void (*rate_relaxations)(const RobotTables& robot, const SceneTables& scene, const PathView& path,
                           const Relaxation& relaxation, float margin,
                           std::span<float, kShortcuts> gains) = nullptr;
};

/// The kernels of an instruction set that this machine has.
[[nodiscard]] const ShortcutKernels& shortcut_kernels(Isa isa);

}  // namespace mneme::internal
