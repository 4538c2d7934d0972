// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A path whose corners are parabolas.
#pragma once

#include "mneme/path.h"

#include <vector>

namespace mneme::internal {

/// Chords that approximate a rounded corner for verification; the margin covers their deviation.
inline constexpr int kChords = 16;

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

/// A straight motion of a path.
struct Leg {
  Configuration begin;
  std::vector<double> direction;  ///< a unit vector
  double length = 0;
};
struct Legs {
  std::vector<Leg> legs;
  Configuration end;
};

/// a + factor * b
[[nodiscard]] std::vector<double> plus(std::vector<double> a, double factor,
                                       const std::vector<double>& b);

/// Unwraps continuous joints and drops waypoints that repeat the last one.
[[nodiscard]] Legs find_legs(const Robot& robot, const Path& path);

/// Returns true for a motion from beyond a limit. A curve at the end of its first leg would stay
/// outside for longer.
[[nodiscard]] bool begins_outside(const Robot& robot, const Path& path);

/// Rounds corners of `path`, which is not empty, by at most `tolerance` (L2 joint distance) where
/// `verifier` passes the parabola; a null `verifier` rounds none. Unwraps continuous joints.
[[nodiscard]] RoundedPath round_corners(const Robot& robot, const Path& path, double tolerance,
                                        const MotionVerifier* verifier);

}  // namespace mneme::internal
