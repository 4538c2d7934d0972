// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The trace of a whole task: objects are links that stand where they are while no hand holds them.
#pragma once

#include "mneme/report.h"
#include "mneme/task.h"

#include "trajectory_file.h"

namespace mneme::app {

/// Returns the trace of a task's plan, for to_page(). Precondition: the plan is solved. Errors:
/// those of make_trace().
/// `planned`: the settings that the task was planned with. `timing`: the options that the motion
/// was timed with.
[[nodiscard]] Result<PlanTrace> trace_task(const TaskResult& plan, const TaskMotion& motion,
                                           const RateLimits& limits, const SolveSettings& planned,
                                           const TrajectoryOptions& timing,
                                           const TraceSettings& settings);

}  // namespace mneme::app
