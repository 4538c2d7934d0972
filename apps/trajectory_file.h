// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The flags of a plan that is to be executed, and the file it is written to.
#pragma once

#include "mneme/trajectory.h"

#include <CLI/CLI.hpp>

#include <span>
#include <string>

namespace mneme::app {

struct TrajectoryOptions {
  std::string file;    ///< its ending says the format; empty if none is wanted
  std::string limits;  ///< YAML file of joint limits; empty: those of the URDF
  TrajectorySettings settings;

  [[nodiscard]] bool is_wanted() const { return !file.empty(); }
};

/// The flags --trajectory and --joint-limits, and those of the settings, which need the first.
void add_trajectory_flags(CLI::App& command, TrajectoryOptions& options);

/// Writes the trajectory, sampled at `dt`, in the format of the file's ending, with the stages of a
/// task if there are any.
[[nodiscard]] Result<void> write_trajectory(const TrajectoryOptions& options, const Robot& robot,
                                            const Trajectory& trajectory,
                                            std::span<const StageBegin> stages = {});

}  // namespace mneme::app
