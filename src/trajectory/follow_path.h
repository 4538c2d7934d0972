// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Motions near a path, from and to rest or a velocity.
#pragma once

#include "mneme/trajectory.h"

#include <vector>

namespace mneme::internal {

/// The arguments of parameterize(), checked.
struct Timing {
  const Robot& robot;
  const RateLimits& limits;
  const TrajectorySettings& settings;
  const MotionVerifier* verifier;
};

/// Velocities at both ends of a motion, a value per joint; empty: at rest.
struct EndVelocities {
  std::vector<double> start, end;
};
/// Errors: as parameterize().
[[nodiscard]] Result<Trajectory> follow_path(const Timing& timing, const Path& path,
                                             const EndVelocities& velocities);

}  // namespace mneme::internal
