// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The fastest spline within rate limits whose control points stay in boxes.
#pragma once

#include "mneme/trajectory.h"

#include <array>
#include <cstddef>
#include <vector>

namespace mneme::internal {

/// A uniform cubic B-spline in time, from rest to rest: its first three control points are the
/// start, its last three the end. Velocity, acceleration and jerk are convex combinations of
/// differences of control points divided by powers of the step, so that limits of these hold at
/// every time.
struct TimeSpline {
  static constexpr std::size_t kFixed = 3;  ///< control points at each end

  double step_s = 0;
  std::vector<std::vector<double>> points;  ///< by joint, then by control point

  [[nodiscard]] std::size_t joint_count() const { return points.size(); }
  [[nodiscard]] std::size_t count() const { return points.front().size(); }
  [[nodiscard]] std::size_t piece_count() const { return count() - kFixed; }
  [[nodiscard]] double duration_s() const { return step_s * static_cast<double>(piece_count()); }
  /// Coefficients of powers of time of a joint on piece `i`, which depends on the control points i
  /// to i + 3.
  [[nodiscard]] std::array<double, 4> piece(std::size_t joint, std::size_t i) const;
};

/// Bounds of each control point, by joint, then by control point.
struct Boxes {
  std::vector<std::vector<double>> lower, upper;
};

/// Newton's method with logarithmic barriers for limits and boxes, on the step and all control
/// points at once. The matrix of a joint has a band of four diagonals; the step is its border.
class TimeBarrier {
 public:
  /// Refers to `limits`.
  explicit TimeBarrier(const RateLimits& limits);

  /// Returns true if the spline is strictly within the limits, by more than rounding errors.
  [[nodiscard]] bool admits(const TimeSpline& spline) const;
  /// Makes `spline` faster; it must be admitted and strictly within `boxes`, and stays so. The
  /// barriers allow for a duration that is longer than the least by about `gap`, as a share of it.
  /// Returns true once that is reached: the last step met no limit.
  bool shorten(TimeSpline& spline, const Boxes& boxes, double gap);

 private:
  /// Newton's equations of a joint, and their solutions for the gradient and for the border.
  struct Joint {
    std::array<std::vector<double>, 4> band;  ///< band[b][i]: row i, column i + b
    std::vector<double> gradient, border;     ///< border: derivatives by the step, too
    std::vector<double> move, border_move;

    void clear(std::size_t count);
    void solve();
  };
  /// Calls `visit` with a joint, its values and their limit for each order of difference that is
  /// limited.
  template <class Visitor>
  void visit_limits(double step_s, std::size_t joint, Visitor&& visit) const;
  template <std::size_t order>
  void add_limit(const TimeSpline& spline, std::size_t j, double limit);
  void add_boxes(const TimeSpline& spline, const Boxes& boxes, std::size_t j);
  [[nodiscard]] double find_step_move() const;
  [[nodiscard]] double find_share(const TimeSpline& spline, const Boxes& boxes,
                                  double step_move) const;

  const RateLimits& limits_;
  std::vector<Joint> joints_;
  double step_gradient_ = 0, step_curvature_ = 0;
  std::vector<double> slopes_, curves_, mixed_;  ///< derivatives by a difference
};

}  // namespace mneme::internal
