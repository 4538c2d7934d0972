// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Builds the kernels' tables of a robot.
#pragma once

#include "collision/tables.h"
#include "mneme/robot.h"

namespace mneme::internal {

/// Error: more joints than the kernels can hold.
[[nodiscard]] Result<RobotTables> make_robot_tables(const Robot& robot);

}  // namespace mneme::internal
