// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme scene enclosed: problems of any robot, as hard as wanted, each with a path.
#include "mneme/instances.h"
#include "mneme/problem.h"

#include "commands.h"
#include "console.h"
#include "files.h"
#include "inputs.h"
#include "options.h"
#include "problem_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <limits>
#include <memory>

namespace mneme::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kMostEnclosed = 100000;
constexpr int kMaxBoxes = 100000;

struct EnclosedOptions {
  std::string robot = "panda";
  RobotOptions robot_options;
  std::string output;
  std::uint64_t seed = 1;
  int count = 20;
  EnclosedSettings settings;
  bool is_json = false;
};

/// A compact file, each problem with its witness.
Json to_json(const EnclosedOptions& options, const Robot& robot, const EnclosedInstances& made) {
  Json file;
  for (std::size_t i = 0; i < made.instances.size(); ++i) {
    const EnclosedInstance& instance = made.instances[i];
    const Problem problem{fmt::format("e{}_{:04}", options.seed, i),
                          robot,
                          "",
                          instance.scene,
                          instance.start,
                          {instance.goal},
                          {}};
    append_problem(problem, options.robot, file)["witness"] = instance.witness;
  }
  file["generator"] = kEnclosedVersion;
  return file;
}

Result<ExitCode> run(EnclosedOptions options) {
  const Result<Robot> robot =
      load_named_robot(options.robot, options.robot_options, std::array{options.output});
  if (!robot) return tl::unexpected(robot.error());
  Progress progress("enclosing");
  options.settings.cancel = interrupt_flag();
  options.settings.on_progress = [&](int made, int dropped) {
    progress.update(made, options.count, fmt::format("{} dropped", dropped));
  };
  const auto made = make_enclosed_instances(*robot, options.count, options.settings, options.seed);
  if (!made) return tl::unexpected(made.error());
  const auto written = write_file(options.output, to_json(options, *robot, *made).dump() + "\n");
  if (!written) return tl::unexpected(written.error());
  if (options.is_json) {
    print_json({{"generator", kEnclosedVersion},
                {"instances", made->instances.size()},
                {"dropped", made->dropped},
                {"file", options.output}});
  } else {
    fmt::print("{} in {}\n", counted(made->instances.size(), "instance", "instances"),
               options.output);
  }
  return interrupt_flag()->load() ? ExitCode::interrupted : ExitCode::done;
}

}  // namespace

void add_scene_enclosed(CLI::App& group, Action& action) {
  const auto options = std::make_shared<EnclosedOptions>();
  CLI::App* command = group.add_subcommand(
      "enclosed", "Write random problems of any robot whose way is enclosed by boxes");
  command->footer(
      "Example:\n  mneme scene enclosed --robot panda --seed 1 -n 20 --clearance 0.01 --boxes 600 "
      "-o enclosed.json");
  command->add_option("--robot", options->robot, "URDF file or name (default panda)");
  add_robot_flags(*command, options->robot_options);
  command->add_option("-o,--output", options->output, "compact problem file to write")->required();
  add_number(*command, "--seed", options->seed, 0, std::numeric_limits<std::uint64_t>::max(),
             "seed of all random numbers; the n-th problem depends on it and on n alone");
  add_number(*command, "-n,--count", options->count, 1, kMostEnclosed, "problems to write");
  add_number(*command, "--clearance", options->settings.clearance, 1e-4, 1,
             "metres that the boxes leave to the robot on its way, at least");
  add_number(*command, "--boxes", options->settings.boxes, 1, kMaxBoxes,
             "boxes around the way, if there is room");
  add_range(*command, "--size", options->settings.size, "metres, full extents of a box");
  add_number(*command, "--through", options->settings.through, 0, 100,
             "random configurations that the way passes");
  add_isa(*command);
  add_json(*command, options->is_json);
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace mneme::app
