// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "robot_file.h"

#include <filesystem>

namespace mneme::app {

Result<std::string> robot_file(const std::string& robot) {
  std::error_code ignored;
  const bool is_path = robot.find('/') != std::string::npos || robot.ends_with(".urdf");
  if (is_path || std::filesystem::is_regular_file(robot, ignored)) return robot;
  return find_robot(robot);
}

}  // namespace mneme::app
