// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Tasks from parsed YAML or JSON.
#pragma once

#include "mneme/task.h"

#include "input/input.h"

namespace mneme::internal {

/// Returns the task of a problem without goals and of the stages under the key `stages` of `input`,
/// checked by check_task(). Failures name the line of a stage, and bound the number of poses.
[[nodiscard]] Task read_task_of(Problem problem, const Input& input);

}  // namespace mneme::internal
