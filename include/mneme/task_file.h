// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Tasks as files, and their plans as JSON.
#pragma once

#include "mneme/base.h"
#include "mneme/problem.h"
#include "mneme/task.h"

#include <string>
#include <vector>

namespace mneme {

/// Reads a task file: a problem file with `stages` instead of goals (docs/tasks.md). Errors name
/// file, line and key.
[[nodiscard]] Result<Task> load_task(const std::string& path, const ProblemOptions& options = {});
/// True for a YAML file with the key `stages`. False for a file that cannot be read.
[[nodiscard]] bool is_task_file(const std::string& path);

/// Reads a list of stages as YAML or JSON text, as the key `stages` of a task file; `source` names
/// it in messages. `start` is that of the task: goals in the frame of a link need it. Errors: those
/// of load_task(); a goal in the frame of a link without a valid start.
[[nodiscard]] Result<std::vector<Stage>> parse_stages(const std::string& text,
                                                      const std::string& source, const Robot& robot,
                                                      const Configuration& start = {});

/// Returns the plan as JSON: status, message, path times and counts, and per stage its kind, path,
/// choice and dropped alternatives. With a `motion`, also its duration and when each stage begins.
[[nodiscard]] std::string to_json(const Task& task, const TaskResult& result,
                                  const TaskMotion* motion = nullptr);

}  // namespace mneme
