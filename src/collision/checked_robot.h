// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What all checkers of one robot share, whatever the scene.
#pragma once

#include <memory>

#include "check/link_distances.h"
#include "collision/tables.h"

namespace mneme::internal {

struct CheckedRobot {
  RobotTables tables;
  LinkDistances links;
  PosedLinks at_zero;  ///< where links that no joint of the group moves always stand
};

/// Made at the first call for a robot or any copy of it, which takes milliseconds, and kept while
/// one of these lives. Thread-safe. Error: as make_robot_tables.
[[nodiscard]] Result<std::shared_ptr<const CheckedRobot>> share_checked_robot(const Robot& robot);

/// Least distance between obstacles and the links that no joint of the group moves.
[[nodiscard]] double fixed_clearance(const CheckedRobot& robot, const Scene& scene);

}  // namespace mneme::internal
