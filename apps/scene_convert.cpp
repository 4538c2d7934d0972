// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "scene_convert.h"

#include <array>
#include <memory>

#include <fmt/format.h>

#include "mneme/problem.h"

#include "console.h"
#include "inputs.h"
#include "options.h"
#include "output_check.h"
#include "output_file.h"

namespace mneme::app {

std::string to_scene_yaml(const FramedScene& scene) {
  if (scene.frame.empty()) return to_yaml(scene.scene);
  return fmt::format("# in the frame of {}\n{}", scene.frame, to_yaml(scene.scene));
}

namespace {

struct ConvertOptions {
  std::string input;
  std::string output = "-";
  std::string format;
  std::string robot;
  std::string frame;
};

Result<FramedScene> read_scene(const ConvertOptions& options) {
  Result<FramedScene> scene = extract_scene(options.input);
  if (!scene || options.robot.empty()) return scene;
  const Result<Robot> robot = load_named_robot(options.robot);
  if (!robot) return tl::unexpected(robot.error());
  return in_root_frame(*scene, *robot).map([&](Scene moved) {
    return FramedScene{std::move(moved), robot->links().front().name};
  });
}

Result<std::string> to_text(const FramedScene& scene, const std::string& format) {
  if (format == "moveit") return to_moveit_yaml(scene);
  return format == "compact" ? to_compact_json(scene) : to_scene_yaml(scene);
}

Result<ExitCode> run_convert(const ConvertOptions& options) {
  const std::array<ReadFile, 1> inputs = {{{"the scene", options.input}}};
  const auto checked = check_outputs(std::array{options.output}, inputs);
  if (!checked) return tl::unexpected(checked.error());
  Result<FramedScene> scene = read_scene(options);
  if (!scene) return tl::unexpected(scene.error());
  if (scene->frame.empty()) scene->frame = options.frame;
  const Result<std::string> text = to_text(*scene, options.format);
  if (!text) return tl::unexpected(text.error());
  if (options.output == "-") {
    fmt::print("{}", *text);
    return ExitCode::done;
  }
  return write_file(options.output, *text).map([&] {
    print_note(fmt::format("wrote {}: {}", options.output,
                           counted(scene->scene.obstacles.size(), "obstacle", "obstacles")));
    return ExitCode::done;
  });
}

}  // namespace

void add_scene_convert(CLI::App& group, Action& action) {
  CLI::App* command =
      group.add_subcommand("convert", "Write a scene as mneme's, MoveIt's or compact file");
  command->footer("Example:\n  mneme scene convert scene0001.yaml -o shelf.yaml --robot fetch");
  const auto options = std::make_shared<ConvertOptions>();
  command
      ->add_option("SCENE", options->input,
                   "scene or problem: YAML file of mneme or MoveIt, or FILE.json#NAME")
      ->required();
  command->add_option("-o,--output", options->output,
                      "file to write, - for standard output (default -)");
  add_choice(*command, "--format", "format", options->format, {"scene", "moveit", "compact"},
             "what to write (default compact if the file ends in .json, otherwise scene)");
  command->add_option("--robot", options->robot,
                      "robot into whose root link's frame the scene is moved: URDF file or name");
  command->add_option("--frame", options->frame,
                      "name of the scene's frame, for scenes that do not say");
  command->callback([options, &action] {
    if (options->format.empty()) {
      options->format = options->output.ends_with(".json") ? "compact" : "scene";
    }
    action = [options] { return run_convert(*options); };
  });
}

}  // namespace mneme::app
