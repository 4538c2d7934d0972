// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Stages from parsed YAML or JSON.
#pragma once

#include "mneme/task.h"

#include "input/input.h"

#include <vector>

namespace mneme::internal {

/// Reads a list of stages. `X_RF`: frame of their poses without a frame, in the root link's frame.
/// Failures name the line of a stage, and bound the number of poses of all stages.
[[nodiscard]] std::vector<Stage> read_stages(const Input& list, const Robot& robot,
                                             const Transform& X_RF);
/// Checks the task whose stages `list` holds; fails at the list.
void check_stages(const Input& list, const Task& task);

}  // namespace mneme::internal
