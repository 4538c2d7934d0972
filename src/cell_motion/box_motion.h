// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Motions of a box of tasks: timed once, bent to each task.
#pragma once

#include "mneme/trajectory.h"

#include "cell/cell_data.h"

#include <array>
#include <optional>
#include <vector>

namespace mneme::internal {

/// A share of a bend as a polynomial of time: coefficients, the constant first.
using TimedShare = std::array<double, 6>;

/// A motion to the middle of a box, and the shares by which it bends with its goal.
struct BoxMotion {
  Trajectory middle;
  std::vector<TimedShare> shares;  ///< by stretch, of the time since it began

  /// The motion to the goal plus `change`. Returns nothing if it may leave the joint limits.
  [[nodiscard]] std::optional<Trajectory> bent(const LinkChain& chain,
                                               const JointVector& change) const;
};

/// Times the path of a proven box, to its middle as `verifier` allows. All motions of the result,
/// for all changes that the box has, keep `limits` and are proven free with the cell's margin.
/// Returns nothing if that fails.
[[nodiscard]] std::optional<BoxMotion> time_box(const CellData& data, const CellBox& box,
                                                const Configuration& start,
                                                const RateLimits& limits,
                                                const TrajectorySettings& settings,
                                                const MotionVerifier& verifier);

}  // namespace mneme::internal
