// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/problem_input.h"

#include "problem/problem_robot.h"

#include <filesystem>

namespace mneme::internal {
namespace {

Configuration read_start(const Input& input, const ProblemOptions& options) {
  return options.start ? *options.start : input.at("start").numbers();
}

std::vector<Configuration> read_goals(const Input& input, const ProblemOptions& options) {
  if (options.goal) {
    return {*options.goal};
  }
  const auto goals = input.find("goals");
  if (!goals) {
    return {input.at("goal").numbers()};
  }
  if (input.find("goal")) {
    goals->fail(ErrorCode::parse, "expected either goal or goals, got both");
  }
  std::vector<Configuration> result;
  for (const Input& goal : goals->items()) {
    result.push_back(goal.numbers());
  }
  if (result.empty()) {
    goals->fail_expecting("at least one goal");
  }
  return result;
}

Scene moved(const Transform& X_AB, Scene scene) {
  for (Obstacle& obstacle : scene.obstacles) {
    for (Shape& shape : obstacle.shapes) {
      shape = transformed(X_AB, shape);
    }
  }
  return scene;
}

}  // namespace

std::string directory_of(const std::string& path) {
  return std::filesystem::path(path).parent_path().string();
}

Problem read_problem(const ProblemInput& input, const ProblemOptions& options) {
  ProblemRobot robot = read_robot(input.header, input.directory, options);
  check_robot_facts(input.problem, robot.robot);
  const Transform X_RF = read_frame(input.header, robot.robot);
  return {input.name,
          robot.robot,
          robot.path,
          moved(X_RF, input.scene),
          read_start(input.problem, options),
          read_goals(input.problem, options),
          std::move(robot.warnings)};
}

}  // namespace mneme::internal
