// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme line: paths that keep a link on a straight line.
#include "mneme/line.h"
#include "mneme/trajectory.h"

#include "commands.h"
#include "console.h"
#include "inputs.h"
#include "options.h"
#include "trajectory_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

namespace mneme::app {
namespace {

using Json = nlohmann::ordered_json;

struct LineOptions {
  std::string robot;
  RobotOptions robot_options;
  std::string scene;
  std::optional<GivenConfiguration> start;
  Line line;
  std::vector<PoseGoal> from, to;
  LineSettings settings;
  TrajectoryOptions trajectory;
  bool is_json = false;
};

void take_link(const std::string& flag, const std::string& link, Line& line) {
  if (!line.link.empty() && line.link != link) {
    throw CLI::ValidationError(
        flag, fmt::format("'{}' is not the link '{}' of another flag", link, line.link));
  }
  line.link = link;
}

/// Completes the line from the flags for poses.
void complete(const CLI::App& command, LineOptions& options) {
  if (command.count("--by") + command.count("--to") != 1) {
    throw CLI::ValidationError("--by, --to", "expected one of both, once");
  }
  for (const PoseGoal& pose : options.to) {
    take_link("--to", pose.link, options.line);
    options.line.target = pose.pose;
    options.line.keeps_rotation = pose.turn > 0;
  }
  for (const PoseGoal& pose : options.from) {
    take_link("--from", pose.link, options.line);
    if (pose.turn > 0 || options.from.size() > 1) {
      throw CLI::ValidationError("--from", "expected one pose with a quaternion");
    }
    options.line.start = pose.pose;
  }
}

/// The start, or what branches are near. Error: not a configuration of the robot.
Result<Configuration> find_start(const LineOptions& options, const PlacedRobot& placed) {
  if (!options.start && !placed.start && !options.line.start) {
    return fail(ErrorCode::invalid,
                "the line starts nowhere: expected --start, --from, or a problem as --scene");
  }
  return placed.robot.configuration_of(options.start.value_or(placed.start_or_zeros()));
}

void print_text(const LineResult& result, double time_s) {
  const LinePath& line = result.line;
  constexpr double kDegrees = 180 / std::numbers::pi;
  const double length = (result.end.translation - result.begin.translation).norm();
  fmt::print("line        {:.1f} % of {:.1f} cm, {}, {}\n", 100 * line.fraction(), 100 * length,
             counted(line.path.size(), "configuration", "configurations"),
             counted(result.branches, "branch", "branches"));
  if (!line.path.empty()) {
    fmt::print("deviation   at most {:.4f} mm and {:.4f} degrees, proven\n",
               1e3 * line.position_deviation, kDegrees * line.rotation_deviation);
  }
  fmt::print("search      {:.3f} ms, {} steps, {} motions checked\n", 1e3 * time_s, result.steps,
             result.checks.motions);
  for (const Configuration& q : line.path) fmt::print("  {:.6f}\n", fmt::join(q, ","));
}

nlohmann::ordered_json to_json(const LineResult& result, double time_s) {
  return {{"is_whole", result.is_whole()},
          {"fraction", result.line.fraction()},
          {"path", result.line.path},
          {"fractions", result.line.fractions},
          {"position_deviation", result.line.position_deviation},
          {"rotation_deviation", result.line.rotation_deviation},
          {"branches", result.branches},
          {"steps", result.steps},
          {"time_s", time_s},
          {"message", result.reason.empty() ? Json() : Json(result.reason)}};
}

Result<void> write_timed(const LineOptions& options, const CollisionChecker& checker,
                         const Path& path) {
  if (!options.trajectory.is_wanted()) return {};
  const Robot& robot = checker.robot();
  const auto limits = MNEME_TRY(find_rate_limits(
      robot, options.trajectory.settings, options.trajectory.limits, options.robot_options.strict));
  for (const std::string& warning : limits.warnings) print_warning(warning);
  const MotionVerifier verifier(checker);
  const auto timed =
      MNEME_TRY(parameterize(robot, path, limits, options.trajectory.settings, &verifier));
  if (!options.is_json) fmt::print("motion      {:.3f} s\n", timed.duration_s());
  return write_trajectory(options.trajectory, robot, timed);
}

Result<ExitCode> run_line(const LineOptions& options) {
  PlacedRobot placed =
      MNEME_TRY(load_placed_robot(options.robot, options.robot_options, options.scene));
  std::vector<ReadFile> inputs = placed.files;
  inputs.push_back({"the file of limits", options.trajectory.limits});
  MNEME_TRY(check_files_to_write(std::array{options.trajectory.file}, inputs));
  placed.robot = MNEME_TRY(narrow_positions(placed.robot, options.trajectory.limits));
  const auto start = MNEME_TRY(find_start(options, placed));
  const auto checker = MNEME_TRY(CollisionChecker::make(placed.robot, placed.scene));
  LineSettings settings = options.settings;
  settings.cancel = interrupt_flag();
  const Stopwatch stopwatch;
  const LineResult result = MNEME_TRY(plan_line(checker, options.line, start, settings));
  const double time_s = stopwatch.elapsed_s();
  if (options.is_json) {
    print_json(to_json(result, time_s));
  } else {
    print_text(result, time_s);
  }
  for (const std::string& note : result.notes) print_note(note);
  if (!result.is_whole()) {
    if (options.trajectory.is_wanted()) {
      print_note(
          fmt::format("'{}' was not written: the line is not whole", options.trajectory.file));
    }
    print_error(result.reason);
    if (result.is_cancelled) return ExitCode::interrupted;
    return result.branches == 0 ? ExitCode::invalid_ends : ExitCode::no_path;
  }
  MNEME_TRY(write_timed(options, checker, result.line.path));
  return ExitCode::done;
}

void add_line_flags(CLI::App& command, LineOptions& options) {
  const auto read_vector = [&options](const std::string& text) {
    const std::vector<double> v = parse_numbers("--by", text);
    const bool is_finite = std::ranges::all_of(v, [](double x) { return std::isfinite(x); });
    if (v.size() != 3 || !is_finite) {
      throw CLI::ValidationError("--by", fmt::format("'{}' is not X,Y,Z in metres", text));
    }
    options.line.displacement = Vec3(v[0], v[1], v[2]);
  };
  add_text(command, "--by", read_vector, "motion of the link, metres; its rotation is kept")
      ->type_name("X,Y,Z");
  add_poses(command, "--to", options.to,
            "pose where the line ends; without the quaternion the link keeps its rotation");
  add_poses(command, "--from", options.from,
            "pose where the line starts, in the root link's frame: all branches of inverse "
            "kinematics are tried");
  command.add_option("--link", options.line.link, "link that moves (default: the group's tip)");
  command.add_option("--frame", options.line.frame,
                     "link whose frame at the start --by and --to are in; the moved link: along "
                     "its own axes (default: the root link)");
  const auto read_axis = [&options](const std::string& text) {
    options.line.free_axis = parse_axis(text);
    if (!options.line.free_axis) {
      throw CLI::ValidationError("--free-axis", fmt::format("'{}' is not x, y or z", text));
    }
  };
  add_text(command, "--free-axis", read_axis,
           "axis of the link about which it may turn freely: x, y or z")
      ->type_name("AXIS");
  add_number(command, "--position-tolerance", options.line.position_tolerance, 1e-6, 1.0,
             "largest deviation from the line, metres");
  add_number(command, "--rotation-tolerance", options.line.rotation_tolerance, 1e-5, 1.0,
             "largest deviation of the rotation, radians");
}

}  // namespace

void add_line(CLI::App& program, Action& action) {
  const auto options = std::make_shared<LineOptions>();
  // The timed motion stays on the line.
  options->trajectory.settings.path_tolerance = 1e-4;
  options->trajectory.settings.time_rounds = 0;
  CLI::App& command = add_command(
      program, action, "line", "Move a link along a straight line",
      "line panda --start 0,-0.785,0,-2.356,0,1.571,0.785 --link panda_hand --by 0,0,-0.1", options,
      run_line, complete);
  add_robot_argument(command, options->robot, options->robot_options);
  command.add_option("--scene", options->scene, "scene or problem with the obstacles");
  add_configuration(command, "--start", options->start,
                    "configuration where the line starts; with --from: branches near it first "
                    "(default: the problem's start)");
  add_line_flags(command, *options);
  add_settings(command, options->settings);
  add_trajectory_flags(command, options->trajectory);
  command.remove_option(command.get_option("--blend-tolerance"));  // one motion joins nothing
  add_isa(command);
  add_json(command, options->is_json);
}

}  // namespace mneme::app
