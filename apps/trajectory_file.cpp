// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "trajectory_file.h"

#include "mneme/report.h"

#include "options.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <span>
#include <string_view>

namespace mneme::app {
namespace {

struct Format {
  std::string_view ending;
  std::string (*write)(const Robot&, std::span<const Trajectory::Point>,
                       std::span<const StageBegin>);
};
constexpr std::array<Format, 4> kFormats = {
    {{".csv", &to_csv}, {".json", &mneme::to_json}, {".yaml", &to_yaml}, {".yml", &to_yaml}}};

/// Null if there is no such format.
const Format* find_format(const std::string& file) {
  const std::string ending = std::filesystem::path(file).extension().string();
  const auto found = std::ranges::find(kFormats, ending, &Format::ending);
  return found == kFormats.end() ? nullptr : &*found;
}

}  // namespace

void add_trajectory_flags(CLI::App& command, TrajectoryOptions& options) {
  const auto read = [&options](const std::string& file) {
    if (find_format(file) == nullptr) {
      throw CLI::ValidationError(
          "--trajectory",
          fmt::format("'{}' ends in no format: expected .csv, .json or .yaml", file));
    }
    options.file = file;
  };
  CLI::Option* trajectory =
      add_text(command, "--trajectory", read,
               "write the timed motion with rounded corners: .csv, .json, or .yaml in the shape of "
               "trajectory_msgs/JointTrajectory");
  trajectory->type_name("FILE");
  command
      .add_option("--joint-limits", options.limits,
                  "limits of velocity, acceleration, jerk and position, YAML as MoveIt's "
                  "joint_limits.yaml (default: those of the URDF)")
      ->type_name("FILE")
      ->needs(trajectory);
  for (CLI::Option* option : add_settings(command, options.settings)) option->needs(trajectory);
}

Result<void> write_trajectory(const TrajectoryOptions& options, const Robot& robot,
                              const Trajectory& trajectory, std::span<const StageBegin> stages) {
  return trajectory.sample(options.settings.dt).and_then([&](const auto& points) {
    return write_file(options.file, find_format(options.file)->write(robot, points, stages));
  });
}

}  // namespace mneme::app
