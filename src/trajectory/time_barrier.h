// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The fastest spline within rate limits whose control points stay in boxes.
#pragma once

#include "mneme/trajectory.h"

#include "trajectory/barrier_kernel.h"

#include <array>
#include <cstddef>
#include <vector>

namespace mneme::internal {

/// Values of joints at control points: rows of `stride` values, of which the last ones are padding.
class PointRows {
 public:
  PointRows() = default;
  PointRows(std::size_t count, std::size_t joints)
      : joints_(joints),
        stride_((joints + kJointLanes - 1) / kJointLanes * kJointLanes),
        values_(count * stride_) {}

  [[nodiscard]] std::size_t count() const { return stride_ > 0 ? values_.size() / stride_ : 0; }
  [[nodiscard]] std::size_t joint_count() const { return joints_; }
  [[nodiscard]] std::size_t stride() const { return stride_; }
  [[nodiscard]] double* operator[](std::size_t i) { return values_.data() + i * stride_; }
  [[nodiscard]] const double* operator[](std::size_t i) const {
    return values_.data() + i * stride_;
  }

 private:
  std::size_t joints_ = 0, stride_ = 0;
  std::vector<double> values_;
};

/// A uniform cubic B-spline in time, from rest to rest: its first three control points are the
/// start, its last three the end. Velocity, acceleration and jerk are convex combinations of
/// differences of control points divided by powers of the step, so that limits of these hold at
/// every time.
struct TimeSpline {
  double step_s = 0;
  PointRows points;

  [[nodiscard]] std::size_t joint_count() const { return points.joint_count(); }
  [[nodiscard]] std::size_t count() const { return points.count(); }
  [[nodiscard]] std::size_t piece_count() const { return count() - kFixedPoints; }
  [[nodiscard]] double duration_s() const { return step_s * static_cast<double>(piece_count()); }
  /// Coefficients of powers of time of a joint on piece `i`, which depends on the control points i
  /// to i + 3.
  [[nodiscard]] std::array<double, 4> piece(std::size_t joint, std::size_t i) const;
};

/// Bounds of control points; padding lies within them.
struct Boxes {
  PointRows lower, upper;
};

/// Newton's method with logarithmic barriers for limits and boxes, on the step and all control
/// points at once. The matrix of a joint has a band of four diagonals; the step is its border.
class TimeBarrier {
 public:
  TimeBarrier(const RateLimits& limits, Isa isa);

  /// Returns true if the spline is strictly within the limits, by more than rounding errors.
  [[nodiscard]] bool admits(const TimeSpline& spline) const;
  /// Makes `spline` faster by some Newton steps; it must be admitted and strictly within `boxes`,
  /// and stays so. The barriers allow for a duration that is longer than the least by about `gap`,
  /// as a share of it. Returns true once that is reached: the last step met no limit.
  bool shorten(TimeSpline& spline, const Boxes& boxes, double gap);

 private:
  const BarrierKernels& kernels_;
  std::array<std::vector<double>, 3> limits_, weights_;  ///< as BarrierTables
  std::vector<double> scratch_;
};

}  // namespace mneme::internal
