// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "trajectory/time_barrier.h"

#include <cmath>

namespace mneme::internal {
namespace {

constexpr int kNewtonSteps = 3;
/// Differences of positions below this, radians or metres, are lost to rounding.
constexpr double kLeastDifference = 1e-7;
/// In place of no limit: so large that differences are nothing, so small that its square is finite.
constexpr double kFarLimit = 1e12;

/// Factors of the control points i, i + 1, .. in a difference of first to third order.
constexpr double kFactors[3][4] = {{-1, 1, 0, 0}, {1, -2, 1, 0}, {-1, 3, -3, 1}};

/// The difference of `order` that begins at a row of control points, for a joint.
double difference(const double* row, std::size_t stride, std::size_t order) {
  double sum = 0;
  for (std::size_t k = 0; k <= order; ++k) sum += kFactors[order - 1][k] * row[k * stride];
  return sum;
}

}  // namespace

std::array<double, 4> TimeSpline::piece(std::size_t joint, std::size_t i) const {
  const double a = points[i][joint], b = points[i + 1][joint], c = points[i + 2][joint];
  const double h = step_s, bend = a - 2 * b + c;
  // Exact where control points are the same, as at both ends.
  return {b + bend / 6, (c - a) / (2 * h), bend / (2 * h * h),
          (points[i + 3][joint] - 3 * c + 3 * b - a) / (6 * h * h * h)};
}

TimeBarrier::TimeBarrier(const RateLimits& limits, Isa isa) : kernels_(barrier_kernels(isa)) {
  const std::array orders = {&limits.velocity, &limits.acceleration, &limits.jerk};
  const std::size_t stride = PointRows(1, limits.velocity.size()).stride();
  for (std::size_t o = 0; o < orders.size(); ++o) {
    limits_[o].assign(stride, kFarLimit);
    weights_[o].assign(stride, 0);
    for (std::size_t j = 0; j < orders[o]->size(); ++j) {
      if (!std::isfinite((*orders[o])[j])) continue;
      limits_[o][j] = (*orders[o])[j];
      weights_[o][j] = 1;
    }
  }
}

bool TimeBarrier::admits(const TimeSpline& spline) const {
  double power = 1;
  for (std::size_t o = 0; o < limits_.size(); ++o) {
    power *= spline.step_s;
    for (std::size_t j = 0; j < spline.joint_count(); ++j) {
      if (!(limits_[o][j] * power >= kLeastDifference) && weights_[o][j] > 0) return false;
    }
    bool is_within = true;
    for (std::size_t i = 0; i + o + 1 < spline.count() && is_within; ++i) {
      for (std::size_t j = 0; j < spline.joint_count(); ++j) {
        const double change = difference(spline.points[i] + j, spline.points.stride(), o + 1);
        is_within &= std::abs(change) < limits_[o][j] * power;
      }
    }
    if (!is_within) return false;
  }
  return true;
}

bool TimeBarrier::shorten(TimeSpline& spline, const Boxes& boxes, double gap) {
  constexpr double kBarriers = 8;  // of a control point of a joint
  const auto values = static_cast<double>(spline.count() * spline.joint_count());
  scratch_.resize(kBarrierArrays * spline.count() * spline.points.stride());
  const BarrierTables tables{spline.count(),
                             spline.points.stride(),
                             spline.points[0],
                             boxes.lower[0],
                             boxes.upper[0],
                             {limits_[0].data(), limits_[1].data(), limits_[2].data()},
                             {weights_[0].data(), weights_[1].data(), weights_[2].data()},
                             scratch_.data()};
  double share = 0;
  for (int k = 0; k < kNewtonSteps; ++k) {
    // The duration of the barriers' minimum is too long by the number of barriers over this weight.
    share = kernels_.newton_step(tables, kBarriers * values / gap / spline.step_s, spline.step_s);
    if (!std::isfinite(share)) return true;
  }
  return share == 1;
}

}  // namespace mneme::internal
