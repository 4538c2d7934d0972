// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "problem_file.h"

#include <filesystem>
#include <utility>

namespace mneme::app {

std::string robot_reference(const std::string& robot) {
  return robot.find('/') == std::string::npos && !robot.ends_with(".urdf")
             ? robot
             : std::filesystem::absolute(robot).lexically_normal().string();
}

nlohmann::ordered_json& append_problem(const Problem& problem, const std::string& robot,
                                       nlohmann::ordered_json& file) {
  auto one = nlohmann::ordered_json::parse(to_compact_json(problem, robot_reference(robot)));
  if (file.is_null()) {
    file = std::move(one);
  } else {
    file["problems"].push_back(std::move(one["problems"][0]));
  }
  return file["problems"].back();
}

}  // namespace mneme::app
