// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme scene: shows, converts and varies scenes.
#include "mneme/instances.h"
#include "mneme/memory.h"
#include "mneme/problem.h"
#include "mneme/report.h"

#include "commands.h"
#include "console.h"
#include "inputs.h"
#include "options.h"
#include "problem_primitives.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <array>
#include <filesystem>
#include <memory>
#include <optional>

namespace mneme::app {
namespace {

/// Text of a scene file, which has no key for a frame: the frame becomes a remark.
std::string to_scene_yaml(const FramedScene& scene) {
  if (scene.frame.empty()) return to_yaml(scene.scene);
  return fmt::format("# in the frame of {}\n{}", scene.frame, to_yaml(scene.scene));
}

void note_lost_frame(const std::string& frame) {
  if (frame.empty()) return;
  print_note(
      fmt::format("a scene file has no key for its frame, '{0}': write 'frame: {0}' in the "
                  "problems that use the scene",
                  frame));
}

struct ConvertOptions {
  std::string input;
  std::string output = "-";
  std::string format;
  std::string robot;
  RobotOptions robot_options;
  std::string frame;
};

/// extract_scene() that prints the scene's warnings.
Result<FramedScene> extract(const std::string& where) {
  Result<FramedScene> scene = extract_scene(where);
  if (!scene) return scene;
  for (const std::string& warning : scene->scene.warnings) print_warning(warning);
  return scene;
}

Result<FramedScene> read_scene(const ConvertOptions& options) {
  FramedScene scene = MNEME_TRY(extract(options.input));
  if (scene.frame.empty()) {
    scene.frame = options.frame;
  } else if (!options.frame.empty() && options.frame != scene.frame) {
    print_note(fmt::format("--frame {} is ignored: the scene is in the frame of {}", options.frame,
                           scene.frame));
  }
  if (options.robot.empty()) return scene;
  const Robot robot = MNEME_TRY(load_named_robot(options.robot, options.robot_options));
  return in_root_frame(scene, robot).map([&](Scene moved) {
    return FramedScene{std::move(moved), robot.links().front().name, scene.files};
  });
}

Result<std::string> to_text(const FramedScene& scene, const std::string& format) {
  if (format == "moveit") return to_moveit_yaml(scene);
  return format == "compact" ? to_compact_json(scene) : to_scene_yaml(scene);
}

Result<ExitCode> run_convert(const ConvertOptions& options) {
  const FramedScene scene = MNEME_TRY(read_scene(options));
  std::vector<ReadFile> inputs;
  add_files("a file of the scene", scene.files, inputs);
  MNEME_TRY(check_outputs(std::array{options.output}, inputs));
  const std::string text = MNEME_TRY(to_text(scene, options.format));
  // Problems without the key `frame` expect the root link's.
  if (options.format == "scene" && options.robot.empty()) note_lost_frame(scene.frame);
  if (options.output == "-") {
    fmt::print("{}", text);
    return ExitCode::done;
  }
  return write_file(options.output, text).map([&] {
    print_note(fmt::format("wrote {}: {}", options.output,
                           counted(scene.scene.obstacles.size(), "obstacle", "obstacles")));
    return ExitCode::done;
  });
}

constexpr int kMaxVariants = 1000000;

struct VaryOptions {
  std::string nominal;
  std::string variations;
  std::string output = ".";
  std::uint64_t seed = 1;
  int count = 10;
  bool is_json = false;
};

Result<std::string> write_one(const VaryOptions& options, const FramedScene& nominal,
                              const Variations& variations, int index) {
  Rng rng(derive_seed(options.seed, static_cast<std::uint64_t>(index)));
  Result<Scene> scene = vary(nominal.scene, variations, rng);
  if (!scene) {
    return fail(scene.error().code,
                fmt::format("{}: {}", options.variations, scene.error().message));
  }
  scene->name = fmt::format("{}_{:04}", nominal.scene.name, index);
  const std::string path =
      (std::filesystem::path(options.output) / (scene->name + ".yaml")).string();
  std::vector<ReadFile> inputs = {{"the file of variations", options.variations}};
  add_files("a file of the scene", nominal.files, inputs);
  return check_outputs(std::array{path}, inputs)
      .and_then([&] {
        return write_file(path, to_scene_yaml({std::move(*scene), nominal.frame}));
      })
      .map([&] { return path; });
}

Result<ExitCode> run_vary(const VaryOptions& options) {
  const FramedScene nominal = MNEME_TRY(extract(options.nominal));
  const Variations variations = MNEME_TRY(load_variations(options.variations));
  MNEME_TRY(make_directory(options.output));
  std::vector<std::string> files;
  for (int i = 1; i <= options.count && !interrupt_flag()->load(); ++i) {
    std::string file = MNEME_TRY(write_one(options, nominal, variations, i));
    files.push_back(std::move(file));
  }
  note_lost_frame(nominal.frame);
  if (options.is_json) {
    print_json({{"seed", options.seed}, {"files", files}});
  } else {
    fmt::print("wrote {} to {}\n", counted(files.size(), "scene", "scenes"), options.output);
  }
  return interrupt_flag()->load() ? ExitCode::interrupted : ExitCode::done;
}

using Json = nlohmann::ordered_json;

struct SceneInfoOptions {
  std::string scene;
  std::string robot;
  RobotOptions robot_options;
  bool is_json = false;
  MemorySettings memory;
};

/// Empty if no robot is known.
using Primitives = std::optional<std::vector<LocalPrimitive>>;

Result<Primitives> primitives_of(const SceneInfoOptions& options, const Workspace& workspace) {
  const auto wrap = [](std::vector<LocalPrimitive> found) { return Primitives(std::move(found)); };
  if (workspace.problem) {
    return decompose(memory_query(*workspace.problem), options.memory).map(wrap);
  }
  if (options.robot.empty()) return Primitives();
  const Robot robot = MNEME_TRY(load_named_robot(options.robot, options.robot_options));
  return in_root_frame(workspace.framed, robot)
      .and_then([&](const Scene& scene) {
        return decompose({robot, scene}, options.memory);
      })
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
    if (!primitive.is_whole_query) fmt::print("gap {:.4f} m, ", primitive.gap);
    fmt::print("key {:.4f}\n", fmt::join(primitive.key, " "));
  }
}

Result<ExitCode> run_info(const SceneInfoOptions& options) {
  const ProblemOptions overrides = MNEME_TRY(problem_options(options.robot, options.robot_options));
  const Workspace workspace = MNEME_TRY(load_workspace(options.scene, overrides));
  const Primitives primitives = MNEME_TRY(primitives_of(options, workspace));
  if (options.is_json) {
    print_json(to_json(workspace.framed.scene, primitives));
  } else {
    print_scene(workspace.framed.scene, primitives);
  }
  return ExitCode::done;
}

void choose_format(const CLI::App&, ConvertOptions& options) {
  if (!options.format.empty()) return;
  options.format = options.output.ends_with(".json") ? "compact" : "scene";
}

void add_convert(CLI::App& group, Action& action) {
  const auto options = std::make_shared<ConvertOptions>();
  CLI::App& command = add_command(group, action, "convert",
                                  "Write a scene as a file of mneme, of MoveIt or a compact file",
                                  "scene convert scene0001.yaml -o shelf.yaml --robot fetch",
                                  options, run_convert, choose_format);
  add_scene_argument(command, options->input);
  command.add_option("-o,--output", options->output,
                     "file to write, - for standard output (default -)");
  add_choice(command, "--format", "format", options->format, {"scene", "moveit", "compact"},
             "format (default compact if the file ends in .json, otherwise scene)");
  command.add_option("--robot", options->robot,
                     "move the scene into the frame of this robot's root link: URDF file or name");
  add_robot_flags(command, options->robot_options);
  command.add_option("--frame", options->frame, "frame of a scene that names none");
}

void add_vary(CLI::App& group, Action& action) {
  const auto options = std::make_shared<VaryOptions>();
  CLI::App& command = add_command(group, action, "vary", "Write random scenes like a given one",
                                  "scene vary scenes/shelf/learn/shelf_1.yaml --variations "
                                  "scenes/shelf/learn/variations.yaml -n 10 --seed 1 -o shelves",
                                  options, run_vary);
  add_scene_argument(command, options->nominal);
  command.add_option("--variations", options->variations, "YAML file of variations")->required();
  command.add_option("-o,--output", options->output,
                     "directory of the scenes NAME_0001.yaml and so on (default .)");
  add_number(command, "-n,--count", options->count, 1, kMaxVariants, "scenes to write");
  add_seed(command, options->seed, "seed; scene number n depends on it and on n only");
  add_json(command, options->is_json);
}

void add_info(CLI::App& group, Action& action) {
  const auto options = std::make_shared<SceneInfoOptions>();
  CLI::App& command = add_command(group, action, "info", "Show obstacles, primitives and gaps",
                                  "scene info scenes/planar/scenario1.yaml", options, run_info);
  add_scene_argument(command, options->scene);
  add_other_robot(command, options->robot, options->robot_options);
  add_memory_settings(command, options->memory);
  add_json(command, options->is_json);
}

}  // namespace

void add_scene(CLI::App& program, Action& action) {
  CLI::App& group = add_group(program, "scene", "Show, convert and vary scenes; make problems",
                              "scene info scenes/planar/scenario1.yaml");
  add_info(group, action);
  add_convert(group, action);
  add_scene_threaded(group, action);
  add_scene_enclosed(group, action);
  add_scene_blocked(group, action);
  add_scene_composed(group, action);
  add_scene_repeat(group, action);
  add_vary(group, action);
}

}  // namespace mneme::app
