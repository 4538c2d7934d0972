// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A path whose corners are parabolas.
#pragma once

#include "mneme/path.h"

#include <vector>

namespace mneme::internal {

/// q(s) = begin + direction s + bend s^2 / 2 for s in [0, length]; radians or metres. `direction`
/// is a unit vector; a parabola begins and ends in the directions of its neighbours.
struct Curve {
  Configuration begin;
  std::vector<double> direction;
  std::vector<double> bend;  ///< empty if it is straight
  double length = 0;
  bool begins_at_rest = false;  ///< at the start, and at a corner that is not rounded

  [[nodiscard]] bool is_straight() const { return bend.empty(); }
  /// q'(s)
  [[nodiscard]] double slope(std::size_t joint, double s) const {
    return is_straight() ? direction[joint] : direction[joint] + bend[joint] * s;
  }
  [[nodiscard]] double value(std::size_t joint, double s) const {
    const double curved = is_straight() ? 0 : 0.5 * bend[joint] * s * s;
    return begin[joint] + direction[joint] * s + curved;
  }
};

/// Straight curves and the parabolas between them.
struct RoundedPath {
  std::vector<Curve> curves;  ///< empty if the path does not move
  Configuration end;
};

/// L2
[[nodiscard]] double norm(const std::vector<double>& v);

/// Rounds corners of `path`, which is not empty, by at most `tolerance` (L2 joint distance) where
/// `verifier` passes the parabola; a null `verifier` rounds none. Unwraps continuous joints.
[[nodiscard]] RoundedPath round_corners(const Robot& robot, const Path& path, double tolerance,
                                        const MotionVerifier* verifier);

}  // namespace mneme::internal
