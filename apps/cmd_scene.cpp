// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme scene: looks at workspaces.
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "mneme/primitive.h"

#include "commands.h"
#include "console.h"
#include "inputs.h"
#include "options.h"
#include "problem_primitives.h"
#include "scene_convert.h"
#include "scene_threaded.h"
#include "scene_vary.h"

namespace mneme::app {
namespace {

using Json = nlohmann::ordered_json;

struct SceneInfoOptions {
  std::string scene;
  std::string robot;
  RobotOptions robot_options;
  bool is_json = false;
  MemorySettings memory;
};

/// Nothing if no robot is known.
using Primitives = std::optional<std::vector<LocalPrimitive>>;

Result<Primitives> primitives_of(const SceneInfoOptions& options, const Workspace& workspace) {
  const auto wrap = [](std::vector<LocalPrimitive> found) { return Primitives(std::move(found)); };
  if (workspace.problem) {
    return find_primitives(*workspace.problem, options.memory).map(wrap);
  }
  if (options.robot.empty()) return Primitives();
  const Result<Robot> robot = load_named_robot(options.robot, options.robot_options);
  if (!robot) return tl::unexpected(robot.error());
  return in_root_frame(workspace.framed, *robot)
      .and_then([&](const Scene& scene) { return decompose({*robot, scene}, options.memory); })
      .map(wrap);
}

std::vector<std::string> obstacle_names(const Scene& scene, const LocalPrimitive& primitive) {
  std::vector<std::string> names;
  for (const int index : primitive.obstacles) {
    names.push_back(scene.obstacles.at(static_cast<std::size_t>(index)).name);
  }
  return names;
}

std::vector<std::string_view> shape_names(const Obstacle& obstacle) {
  std::vector<std::string_view> names;
  for (const Shape& shape : obstacle.shapes) names.push_back(shape_name(shape));
  return names;
}

Json to_json(const Scene& scene, const Primitives& primitives) {
  Json obstacles = Json::array();
  for (const Obstacle& obstacle : scene.obstacles) {
    obstacles.push_back({{"name", obstacle.name}, {"shapes", shape_names(obstacle)}});
  }
  Json found;
  if (primitives) found = Json::array();
  for (const LocalPrimitive& primitive : primitives.value_or(std::vector<LocalPrimitive>())) {
    found.push_back({{"obstacles", obstacle_names(scene, primitive)},
                     {"key", primitive.key},
                     {"gap", primitive.gap}});
  }
  return {{"name", scene.name}, {"obstacles", obstacles}, {"primitives", found}};
}

void print_scene(const Scene& scene, const Primitives& primitives) {
  fmt::print("scene       {}\n", printable(scene.name));
  fmt::print("obstacles   {}\n", scene.obstacles.size());
  for (const Obstacle& obstacle : scene.obstacles) {
    fmt::print("  {}: {}\n", printable(obstacle.name), fmt::join(shape_names(obstacle), ", "));
  }
  if (!primitives) {
    fmt::print("primitives  depend on the robot: give --robot\n");
    return;
  }
  fmt::print("primitives  {}\n", primitives->size());
  for (std::size_t i = 0; i < primitives->size(); ++i) {
    const LocalPrimitive& primitive = (*primitives)[i];
    fmt::print("  {}: ", describe(scene, primitive, i));
    if (!is_query(primitive)) fmt::print("gap {:.4f} m, ", primitive.gap);
    fmt::print("key {:.4f}\n", fmt::join(primitive.key, " "));
  }
}

Result<ExitCode> run_info(const SceneInfoOptions& options) {
  const Result<ProblemOptions> overrides = problem_options(options.robot, options.robot_options);
  if (!overrides) return tl::unexpected(overrides.error());
  const Result<Workspace> workspace = load_workspace(options.scene, *overrides);
  if (!workspace) return tl::unexpected(workspace.error());
  const Result<Primitives> primitives = primitives_of(options, *workspace);
  if (!primitives) return tl::unexpected(primitives.error());
  if (options.is_json) {
    print_json(to_json(workspace->framed.scene, *primitives));
  } else {
    print_scene(workspace->framed.scene, *primitives);
  }
  return ExitCode::done;
}

void add_info(CLI::App& group, Action& action) {
  const auto options = std::make_shared<SceneInfoOptions>();
  CLI::App* command = group.add_subcommand("info", "Show obstacles, primitives and gaps");
  command->footer("Example:\n  mneme scene info scenes/planar/scenario1.yaml");
  command->add_option("SCENE", options->scene, "scene or problem: YAML file, or FILE.json#NAME")
      ->required();
  command->add_option("--robot", options->robot,
                      "robot that decides about primitives: URDF file or name (default: that of "
                      "the problem)");
  add_robot_flags(*command, options->robot_options);
  add_memory_settings(*command, options->memory);
  add_json(*command, options->is_json);
  command->callback([options, &action] { action = [options] { return run_info(*options); }; });
}

}  // namespace

void add_scene(CLI::App& program, Action& action) {
  CLI::App* group = program.add_subcommand("scene", "Look at workspaces and make problems");
  group->require_subcommand(1);
  group->footer("Example:\n  mneme scene info scenes/planar/scenario1.yaml");
  add_info(*group, action);
  add_scene_convert(*group, action);
  add_scene_threaded(*group, action);
  add_scene_vary(*group, action);
}

}  // namespace mneme::app
