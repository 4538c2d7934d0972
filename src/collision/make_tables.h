// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Builds the kernels' tables from a robot and a scene.
#pragma once

#include "collision/tables.h"
#include "mneme/robot.h"
#include "mneme/scene.h"

namespace mneme::internal {

/// Error: more joints or moving links with shapes than the kernels can hold.
[[nodiscard]] Result<RobotTables> make_robot_tables(const Robot& robot);

/// Errors: an obstacle without shapes, not finite, or of a kind that the kernels lack.
[[nodiscard]] Result<SceneTables> make_scene_tables(const Scene& scene);

}  // namespace mneme::internal
