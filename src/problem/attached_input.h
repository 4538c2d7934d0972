// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Objects that links carry, as problem files list them.
#pragma once

#include "mneme/robot.h"

#include "scene/input.h"
#include "scene/shape_fields.h"

#include <string>
#include <vector>

namespace mneme::internal {

/// The objects of the list `attached` of `problem`, if there is one; files are relative to
/// `directory`. Throws InputFailure, also for links that the robot lacks and names that are taken.
[[nodiscard]] std::vector<AttachedObject> read_attached(const Input& problem,
                                                        const ObstacleSpelling& spelling,
                                                        const std::string& directory,
                                                        const Robot& robot);

/// mneme::attach. Throws InputFailure with `place`.
[[nodiscard]] Robot attach_to(const Robot& robot, std::vector<AttachedObject> objects,
                              const Input& place);

}  // namespace mneme::internal
