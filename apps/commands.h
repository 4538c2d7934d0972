// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The subcommands and their exit codes. To add a subcommand: cmd_<verb>.cpp, a declaration here, a
/// call in main.cpp.
#pragma once

#include "mneme/base.h"
#include "mneme/planning.h"

#include <CLI/CLI.hpp>

#include <functional>

namespace mneme::app {

/// Part of the interface: never renumber.
enum class ExitCode {
  done = 0,          ///< Done, or solved.
  failure = 1,       ///< An error in a file, the robot or the scene.
  usage = 2,         ///< A wrong command line.
  no_path = 3,       ///< No path within the limits.
  invalid_ends = 4,  ///< Start or goal is in contact, outside the limits or not a configuration.
  bad_database = 5,  ///< A database of another robot, or a corrupt one.
  interrupted = 130,
};

[[nodiscard]] constexpr ExitCode exit_code(ErrorCode code) {
  const bool is_database = code == ErrorCode::wrong_robot || code == ErrorCode::corrupt;
  return is_database ? ExitCode::bad_database : ExitCode::failure;
}

[[nodiscard]] constexpr ExitCode exit_code(PlanStatus status) {
  switch (status) {
    case PlanStatus::solved:
      return ExitCode::done;
    case PlanStatus::timeout:
    case PlanStatus::iteration_limit:
    case PlanStatus::node_limit:
      return ExitCode::no_path;
    case PlanStatus::cancelled:
      return ExitCode::interrupted;
    case PlanStatus::invalid_start:
    case PlanStatus::invalid_goal:
      return ExitCode::invalid_ends;
  }
  return ExitCode::failure;
}

/// The work of a parsed command line. An error becomes a message and an exit code.
using Action = std::function<Result<ExitCode>()>;

// Each adds its flags to the program; if it is the subcommand chosen, parsing sets `action`.
void add_demo(CLI::App& program, Action& action);
void add_plan(CLI::App& program, Action& action);
void add_line(CLI::App& program, Action& action);
void add_learn(CLI::App& program, Action& action);
void add_db(CLI::App& program, Action& action);
void add_robot(CLI::App& program, Action& action);
void add_scene(CLI::App& program, Action& action);
void add_cell(CLI::App& program, Action& action);
void add_bench(CLI::App& program, Action& action);
void add_view(CLI::App& program, Action& action);
void add_serve(CLI::App& program, Action& action);
void add_doctor(CLI::App& program, Action& action);
void add_completion(CLI::App& program, Action& action);
void add_manual(CLI::App& program, Action& action);
void add_settings_list(CLI::App& program, Action& action);
// Each adds its subcommands to `group`, or to the group `bench`.
void add_bench_report(CLI::App& bench, Action& action);
void add_db_upkeep(CLI::App& group, Action& action);
void add_robot_ik(CLI::App& group, Action& action);
void add_robot_spheres(CLI::App& group, Action& action);
void add_robot_srdf(CLI::App& group, Action& action);
void add_scene_enclosed(CLI::App& group, Action& action);
void add_scene_blocked(CLI::App& group, Action& action);
void add_scene_composed(CLI::App& group, Action& action);
void add_scene_threaded(CLI::App& group, Action& action);
void add_scene_repeat(CLI::App& group, Action& action);

}  // namespace mneme::app
