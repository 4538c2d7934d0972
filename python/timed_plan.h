// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The class mneme.Trajectory.
#pragma once

#include "mneme/task.h"
#include "mneme/trajectory.h"

#include <pybind11/pybind11.h>

#include <string>
#include <vector>

namespace mneme::python {

/// A sampled trajectory.
struct TimedPlan {
  Robot robot;
  std::vector<Trajectory::Point> points;
  std::vector<StageBegin> stages = {};  ///< of a task
};

/// Returns the limits of a file, or of the URDF, and issues their warnings.
[[nodiscard]] RateLimits find_limits(const Robot& robot, const TrajectorySettings& timing,
                                     const pybind11::object& limits);

}  // namespace mneme::python
