// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What all checkers of one robot share, whatever the scene.
#pragma once

#include <memory>
#include <vector>

#include "collision/tables.h"
#include "mneme/robot.h"

namespace mneme::internal {

struct CheckedRobot {
  RobotTables tables;
  /// The shapes that no joint of the group moves, in the root's frame; a sphere is a capsule of
  /// length 0.
  std::vector<Capsule> fixed_shapes;
};

/// Made at the first call for a robot or any copy of it, which takes milliseconds, and kept while
/// one of these lives. Thread-safe. Error: as make_robot_tables.
[[nodiscard]] Result<std::shared_ptr<const CheckedRobot>> share_checked_robot(const Robot& robot);

}  // namespace mneme::internal
