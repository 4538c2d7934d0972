// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// From URDF text to the parts of a robot.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "mneme/robot.h"

namespace mneme::internal {

/// The links and joints, checked and in tree order. `source` names the text in messages; meshes are
/// relative to it.
[[nodiscard]] Result<Robot::Parts> read_urdf(std::string_view urdf, const std::string& source,
                                             const std::vector<std::string>& package_paths);

}  // namespace mneme::internal
