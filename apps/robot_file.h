// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Robots by file or by name, as command line and Python take them.
#pragma once

#include <string>

#include "mneme/robot.h"

namespace mneme::app {

/// The URDF file that `robot`, a file or the name of a known robot, stands for.
[[nodiscard]] Result<std::string> robot_file(const std::string& robot);

}  // namespace mneme::app
