// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What the program's exit code says. Part of the interface: never renumber.
#pragma once

#include "mneme/base.h"
#include "mneme/planning.h"

namespace mneme::app {

enum class ExitCode {
  done = 0,          ///< done, or solved
  failure = 1,       ///< a file or the world is wrong
  usage = 2,         ///< a wrong command line
  no_path = 3,       ///< no path within the limit
  invalid_ends = 4,  ///< the start or goal is in contact, outside the limits or not a configuration
  bad_database = 5,  ///< a database of another robot, or a corrupt one
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

}  // namespace mneme::app
