// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The class mneme.Trajectory.
#pragma once

#include "mneme/task.h"
#include "mneme/trajectory.h"

#include <pybind11/pybind11.h>

#include <optional>
#include <string>
#include <vector>

namespace mneme::python {

/// A sampled trajectory.
struct TimedPlan {
  Robot robot;
  std::vector<Trajectory::Point> points;
  std::vector<StageBegin> stages = {};           ///< of a task
  std::optional<bool> is_of_box = std::nullopt;  ///< of a cell's answer: CellMotion::is_of_box
};

/// Reads `dt`, unless it is None, and the other arguments of a method that times a motion into
/// `timing`. `method`: its name in messages.
[[nodiscard]] TrajectorySettings read_trajectory_settings(const std::string& method,
                                                          const pybind11::object& dt,
                                                          const pybind11::kwargs& arguments,
                                                          TrajectorySettings timing = {});

/// Returns the name of a file; empty for None.
[[nodiscard]] std::string file_name(const pybind11::object& path);

/// Returns the limits of a file, or of the URDF, and issues their warnings.
[[nodiscard]] RateLimits find_limits(const Robot& robot, const TrajectorySettings& timing,
                                     const pybind11::object& limits);

}  // namespace mneme::python
