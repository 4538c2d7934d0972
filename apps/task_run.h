// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme plan for a file with stages.
#pragma once

#include "mneme/task.h"

#include "commands.h"
#include "trajectory_file.h"

#include <string>

namespace mneme::app {

struct TaskRunOptions {
  std::string file;
  ProblemOptions reading;
  RobotOptions robot;
  std::string db;
  DatabaseSettings kept;
  std::string view;  ///< page to write; empty: none
  TrajectoryOptions trajectory;
  bool is_json = false;
  TaskSettings settings;
};

/// Plans a task, prints its stages, and writes the files of the options.
[[nodiscard]] Result<ExitCode> run_task(const TaskRunOptions& options);

}  // namespace mneme::app
