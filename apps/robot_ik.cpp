// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme robot ik: configurations that bring a link to a pose.
#include "mneme/goal.h"
#include "mneme/path.h"

#include "commands.h"
#include "console.h"
#include "inputs.h"
#include "options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace mneme::app {
namespace {

using Json = nlohmann::ordered_json;

struct IkOptions {
  std::string robot;
  RobotOptions robot_options;
  std::string scene;
  std::vector<PoseGoal> poses;
  std::optional<GivenConfiguration> near;
  IkSettings settings;
  bool is_json = false;
};

void print_solutions(const Robot& robot, const Configuration& near,
                     const std::vector<Configuration>& solutions) {
  for (const Configuration& q : solutions) {
    fmt::print("{:.6f}  ({:.3f} away)\n", fmt::join(q, ","), robot.distance(near, q));
  }
}

Json to_json(const Robot& robot, const Configuration& near,
             const std::vector<Configuration>& solutions) {
  Json rows = Json::array();
  for (const Configuration& q : solutions) {
    rows.push_back({{"q", q}, {"distance", robot.distance(near, q)}});
  }
  return rows;
}

/// The start of the search. Errors: not a configuration of the robot.
Result<Configuration> find_near(const IkOptions& options, const PlacedRobot& placed) {
  const auto near = placed.robot.configuration_of(options.near.value_or(placed.start_or_zeros()));
  if (!near) return fail(near.error().code, "--near: " + near.error().message);
  if (auto violation = placed.robot.describe_violation(*near, "--near")) {
    return fail(ErrorCode::invalid, *violation);
  }
  return near;
}

Result<ExitCode> run_ik(const IkOptions& options) {
  const auto placed =
      MNEME_TRY(load_placed_robot(options.robot, options.robot_options, options.scene));
  for (const PoseGoal& pose : options.poses) {
    if (const auto fault = describe_fault(placed.robot, pose)) {
      return fail(ErrorCode::invalid, "--pose: " + *fault);
    }
  }
  const auto near = MNEME_TRY(find_near(options, placed));
  const auto checker = MNEME_TRY(CollisionChecker::make(placed.robot, placed.scene));
  auto source = MNEME_TRY(
      PoseGoalSource::make(checker, options.poses, near, options.settings, kVerificationMargin));
  const std::vector<Configuration> solutions = source.find_all();
  const std::string failure = solutions.empty() ? source.describe_failure() : "";
  if (options.is_json) {
    print_json({{"solutions", to_json(placed.robot, near, solutions)},
                {"message", failure.empty() ? Json() : Json(failure)}});
  } else {
    print_solutions(placed.robot, near, solutions);
  }
  if (!failure.empty()) print_error(failure);
  return solutions.empty() ? ExitCode::invalid_ends : ExitCode::done;
}

}  // namespace

void add_robot_ik(CLI::App& group, Action& action) {
  const auto options = std::make_shared<IkOptions>();
  CLI::App& command = add_command(
      group, action, "ik", "Find configurations that bring a link to a pose",
      "robot ik panda --pose panda_hand:0.4,0.1,0.5,1,0,0,0 --scene shelf.yaml", options, run_ik);
  add_robot_argument(command, options->robot, options->robot_options);
  add_poses(command, "--pose", options->poses,
            "pose in the root link's frame, any rotation without the quaternion; repeatable: "
            "configurations may reach any one")
      ->required();
  add_configuration(command, "--near", options->near,
                    "start of the search; the nearest solution is printed first (default: the "
                    "problem's start, or zeros)");
  command.add_option("--scene", options->scene, "scene or problem with the obstacles");
  add_settings(command, options->settings);
  add_seed(command, options->settings.seed, "seed of the random configurations");
  add_isa(command);
  add_json(command, options->is_json);
}

}  // namespace mneme::app
