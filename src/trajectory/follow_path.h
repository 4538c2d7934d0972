// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Motions near a path, from rest or from a velocity.
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

[[nodiscard]] Trajectory follow_from_rest(const Timing& timing, const Path& path);
/// Errors: as parameterize().
[[nodiscard]] Result<Trajectory> follow_from_velocity(const Timing& timing, const Path& path,
                                                      const std::vector<double>& velocity);

}  // namespace mneme::internal
