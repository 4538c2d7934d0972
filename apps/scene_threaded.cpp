// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/instances.h"
#include "mneme/learning.h"

#include "commands.h"
#include "console.h"
#include "files.h"
#include "inputs.h"
#include "options.h"
#include "problem_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <memory>

namespace mneme::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kMaxCount = 1000000;

struct ThreadedOptions {
  std::string robot = "planar8";
  std::string output;
  std::uint64_t seed = 1;
  int count = 100;
  ThreadedSettings settings;
  bool is_json = false;
};

Result<void> set_depth(const std::array<double, 2>& depth, ThreadedSettings& settings) {
  for (std::size_t i = 0; i < 2; ++i) {
    if (!(depth[i] >= 1 && depth[i] <= 1000) || depth[i] != std::floor(depth[i])) {
      return fail(ErrorCode::invalid, "--depth: expected whole numbers of links, such as 3:5");
    }
    settings.depth[i] = static_cast<int>(depth[i]);
  }
  return {};
}

Json to_json(const ThreadedInstance& instance, std::size_t index, std::uint64_t seed) {
  return {{"name", fmt::format("s{}_{:04}", seed, index)},
          {"circles", instance.circles},
          {"start", instance.start},
          {"goal", instance.goal},
          {"gap", instance.gap},
          {"depth", instance.depth},
          {"witness", instance.witness}};
}

Json to_json(const ThreadedOptions& options, const ThreadedInstances& made) {
  Json problems = Json::array();
  for (std::size_t i = 0; i < made.instances.size(); ++i) {
    problems.push_back(to_json(made.instances[i], i, options.seed));
  }
  return {{"robot", robot_reference(options.robot)},
          {"generator", kThreadedVersion},
          {"seed", options.seed},
          {"gap", options.settings.gap},
          {"depth", options.settings.depth},
          {"passages", options.settings.passages},
          {"dropped", made.dropped},
          {"problems", problems}};
}

Result<ExitCode> run(ThreadedOptions options, const std::array<double, 2>& depth) {
  if (auto set = set_depth(depth, options.settings); !set) return tl::unexpected(set.error());
  const Result<Robot> robot = load_named_robot(options.robot, {}, std::array{options.output});
  if (!robot) return tl::unexpected(robot.error());
  const auto exit_code = [] {
    return interrupt_flag()->load() ? ExitCode::interrupted : ExitCode::done;
  };
  Progress progress("threading");
  options.settings.cancel = interrupt_flag();
  options.settings.on_progress = [&](int made, int dropped) {
    progress.update(made, options.count, fmt::format("{} dropped", dropped));
  };
  const auto made = make_threaded_instances(*robot, options.count, options.settings, options.seed);
  if (!made) return tl::unexpected(made.error());
  const std::string text = to_json(options, *made).dump() + "\n";
  if (options.output == "-") {
    fmt::print("{}", text);
    return exit_code();
  }
  auto written = write_file(options.output, text);
  if (!written) return tl::unexpected(written.error());
  if (options.is_json) {
    print_json({{"generator", kThreadedVersion},
                {"instances", made->instances.size()},
                {"dropped", made->dropped},
                {"file", options.output}});
  } else {
    fmt::print("{} instances in {}, {} dropped that the proof did not solve\n",
               made->instances.size(), options.output, made->dropped);
  }
  return exit_code();
}

}  // namespace

void add_scene_threaded(CLI::App& group, Action& action) {
  const auto options = std::make_shared<ThreadedOptions>();
  const auto depth = std::make_shared<std::array<double, 2>>(std::array<double, 2>{3, 5});
  CLI::App* command = group.add_subcommand(
      "threaded", "Write random problems of an arm threaded through a gap, each proven feasible");
  command->footer(
      "Example:\n  mneme scene threaded --robot planar8 --seed 1 -n 100 --gap 0.1:0.3 --depth 3:5 "
      "-o threaded.json");
  command->add_option("--robot", options->robot, "planar arm: URDF file or name (default planar8)");
  command
      ->add_option("-o,--output", options->output,
                   "compact problem file to write, - for standard output")
      ->required();
  add_number(*command, "--seed", options->seed, 0, std::numeric_limits<std::uint64_t>::max(),
             "seed of all random numbers");
  add_number(*command, "-n,--count", options->count, 1, kMaxCount, "problems to write");
  add_range(*command, "--gap", options->settings.gap, "metres between the two circles");
  add_range(*command, "--depth", *depth, "links from the first one that crosses the gap");
  add_number(*command, "--passages", options->settings.passages, 1, 3,
             "gaps: the start's, the goal's, and one in reach of the arm");
  add_isa(*command);
  add_json(*command, options->is_json);
  command->callback(
      [options, depth, &action] { action = [options, depth] { return run(*options, *depth); }; });
}

}  // namespace mneme::app
