// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/problem_input.h"

#include "problem/problem_robot.h"
#include "scene/scene_builder.h"
#include "scene/scene_input.h"

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

}  // namespace

Scene read_scene_of_problem(const Input& problem, const std::string& path) {
  const auto named = problem.find("name");
  const std::string name = named ? named->text() : std::filesystem::path(path).stem().string();
  const Input scene = problem.at("scene");
  if (scene.is_text()) {
    return value_or_throw(
        load_scene((std::filesystem::path(directory_of(path)) / scene.text()).string()));
  }
  if (!scene.is_map()) {
    scene.fail_expecting("a scene, or the path of a scene file");
  }
  return read_scene(scene, name);
}

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
