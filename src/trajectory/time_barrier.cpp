// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "trajectory/time_barrier.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace mneme::internal {
namespace {

constexpr int kNewtonSteps = 4;
/// Differences of positions below this, radians or metres, are lost to rounding.
constexpr double kLeastDifference = 1e-7;

template <std::size_t order>
using Order = std::integral_constant<std::size_t, order>;

/// Factors of the control points i, i + 1, .. in a difference.
template <std::size_t order>
constexpr std::array<double, order + 1> factors() {
  if constexpr (order == 1) return {-1, 1};
  if constexpr (order == 2) return {1, -2, 1};
  if constexpr (order == 3) return {-1, 3, -3, 1};
}

template <std::size_t order>
double difference(const double* p) {
  double sum = 0;
  for (std::size_t k = 0; k <= order; ++k) sum += factors<order>()[k] * p[k];
  return sum;
}

}  // namespace

std::array<double, 4> TimeSpline::piece(std::size_t joint, std::size_t i) const {
  const double* p = points[joint].data() + i;
  const double h = step_s;
  // Exact where control points are the same, as at both ends.
  return {p[1] + difference<2>(p) / 6, (p[2] - p[0]) / (2 * h), difference<2>(p) / (2 * h * h),
          difference<3>(p) / (6 * h * h * h)};
}

TimeBarrier::TimeBarrier(const RateLimits& limits)
    : limits_(limits), joints_(limits.velocity.size()) {}

template <class Visitor>
void TimeBarrier::visit_limits(double step_s, std::size_t joint, Visitor&& visit) const {
  visit(Order<1>(), limits_.velocity[joint] * step_s);
  visit(Order<2>(), limits_.acceleration[joint] * step_s * step_s);
  const bool has_jerk = !limits_.jerk.empty() && std::isfinite(limits_.jerk[joint]);
  if (has_jerk) visit(Order<3>(), limits_.jerk[joint] * step_s * step_s * step_s);
}

bool TimeBarrier::admits(const TimeSpline& spline) const {
  bool is_admitted = true;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    visit_limits(spline.step_s, j, [&]<std::size_t order>(Order<order>, double limit) {
      if (!(limit >= kLeastDifference)) is_admitted = false;
      for (std::size_t i = 0; i + order < spline.count() && is_admitted; ++i) {
        is_admitted = std::abs(difference<order>(&spline.points[j][i])) < limit;
      }
    });
  }
  return is_admitted;
}

void TimeBarrier::Joint::clear(std::size_t count) {
  for (auto& diagonal : band) diagonal.assign(count, 0.0);
  for (auto* vector : {&gradient, &border, &move, &border_move}) vector->assign(count, 0.0);
}

/// -log(limit - g) - log(limit + g) for all differences g; the limit grows with the step. Curvature
/// of the limit, which is negative, is left out.
template <std::size_t order>
void TimeBarrier::add_limit(const TimeSpline& spline, std::size_t j, double limit) {
  const double limit_slope = static_cast<double>(order) * limit / spline.step_s;
  const std::size_t count = spline.count() - order;
  double slope = 0, curve = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double g = difference<order>(&spline.points[j][i]);
    const double up = 1 / (limit - g), down = 1 / (limit + g);
    slopes_[i] = up - down;
    curves_[i] = up * up + down * down;
    mixed_[i] = limit_slope * (down * down - up * up);
    slope += up + down;
    curve += curves_[i];
  }
  step_gradient_ -= limit_slope * slope;
  step_curvature_ += limit_slope * limit_slope * curve;
  Joint& joint = joints_[j];
  constexpr auto kFactors = factors<order>();
  for (std::size_t k = 0; k <= order; ++k) {
    for (std::size_t i = 0; i < count; ++i) joint.gradient[i + k] += kFactors[k] * slopes_[i];
    for (std::size_t i = 0; i < count; ++i) joint.border[i + k] += kFactors[k] * mixed_[i];
    for (std::size_t b = 0; b + k <= order; ++b) {
      const double product = kFactors[k] * kFactors[k + b];
      double* diagonal = joint.band[b].data() + k;
      for (std::size_t i = 0; i < count; ++i) diagonal[i] += product * curves_[i];
    }
  }
}

void TimeBarrier::add_boxes(const TimeSpline& spline, const Boxes& boxes, std::size_t j) {
  Joint& joint = joints_[j];
  for (std::size_t i = TimeSpline::kFixed; i + TimeSpline::kFixed < spline.count(); ++i) {
    const double p = spline.points[j][i];
    const double up = 1 / (boxes.upper[j][i] - p), down = 1 / (p - boxes.lower[j][i]);
    joint.gradient[i] += up - down;
    joint.band[0][i] += up * up + down * down;
  }
}

/// Decomposes the band into L D L' and solves for the free control points; the others do not move.
void TimeBarrier::Joint::solve() {
  auto& [d, b1, b2, b3] = band;
  const std::size_t begin = TimeSpline::kFixed, end = d.size() - TimeSpline::kFixed;
  double *x = move.data(), *y = border_move.data();
  for (std::size_t i = begin; i < end; ++i) x[i] = -gradient[i], y[i] = border[i];
  for (std::size_t i = begin; i < end; ++i) {
    const double inverse = 1 / d[i];
    const double f1 = b1[i] * inverse, f2 = b2[i] * inverse, f3 = b3[i] * inverse;
    d[i + 1] -= f1 * b1[i], b1[i + 1] -= f1 * b2[i], b2[i + 1] -= f1 * b3[i];
    d[i + 2] -= f2 * b2[i], b1[i + 2] -= f2 * b3[i];
    d[i + 3] -= f3 * b3[i];
    x[i + 1] -= f1 * x[i], x[i + 2] -= f2 * x[i], x[i + 3] -= f3 * x[i];
    y[i + 1] -= f1 * y[i], y[i + 2] -= f2 * y[i], y[i + 3] -= f3 * y[i];
    x[i] *= inverse, y[i] *= inverse;
    b1[i] = f1, b2[i] = f2, b3[i] = f3;
  }
  for (std::size_t i = end; i < d.size(); ++i) x[i] = y[i] = 0;
  for (std::size_t i = end; i-- > begin;) {
    x[i] -= b1[i] * x[i + 1] + b2[i] * x[i + 2] + b3[i] * x[i + 3];
    y[i] -= b1[i] * y[i + 1] + b2[i] * y[i + 2] + b3[i] * y[i + 3];
  }
}

/// Eliminates the control points: [B c; c' d] [x; y] = -[g; e].
double TimeBarrier::find_step_move() const {
  double gradient = step_gradient_, curvature = step_curvature_;
  for (const Joint& joint : joints_) {
    for (std::size_t i = 0; i < joint.border.size(); ++i) {
      gradient += joint.border[i] * joint.move[i];
      curvature -= joint.border[i] * joint.border_move[i];
    }
  }
  return curvature > 0 ? -gradient / curvature : 0;
}

/// The share of the move, at most 1, that leaves at least a tenth of the room to each limit.
double TimeBarrier::find_share(const TimeSpline& spline, const Boxes& boxes,
                               double step_move) const {
  constexpr double kKept = 0.1;
  double most = std::max(0.0, -step_move / spline.step_s);  // lost room, as a share of the room
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const double *p = spline.points[j].data(), *move = joints_[j].move.data();
    visit_limits(spline.step_s, j, [&]<std::size_t order>(Order<order>, double limit) {
      // Powers of the step are convex: they are above their tangent.
      const double change = static_cast<double>(order) * limit / spline.step_s * step_move;
      for (std::size_t i = 0; i + order < spline.count(); ++i) {
        const double g = difference<order>(p + i), dg = difference<order>(move + i);
        const double up = (dg - change) / (limit - g), down = (-dg - change) / (limit + g);
        most = std::max(most, std::max(up, down));
      }
    });
    for (std::size_t i = TimeSpline::kFixed; i + TimeSpline::kFixed < spline.count(); ++i) {
      const double up = move[i] / (boxes.upper[j][i] - p[i]);
      const double down = -move[i] / (p[i] - boxes.lower[j][i]);
      most = std::max(most, std::max(up, down));
    }
  }
  return std::min(1.0, (1 - kKept) / most);
}

bool TimeBarrier::shorten(TimeSpline& spline, const Boxes& boxes, double gap) {
  constexpr double kBarriers = 8;  // of a control point of a joint
  const std::size_t count = spline.count();
  for (auto* values : {&slopes_, &curves_, &mixed_}) values->resize(count);
  bool is_full = false;
  for (int k = 0; k < kNewtonSteps; ++k) {
    // The duration of the barriers' minimum is too long by the number of barriers over this weight.
    step_gradient_ = kBarriers * static_cast<double>(count * joints_.size()) / gap / spline.step_s;
    step_curvature_ = 0;
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      joints_[j].clear(count);
      visit_limits(spline.step_s, j, [&]<std::size_t order>(Order<order>, double limit) {
        add_limit<order>(spline, j, limit);
      });
      add_boxes(spline, boxes, j);
      joints_[j].solve();
    }
    const double step_move = find_step_move();
    for (Joint& joint : joints_) {
      for (std::size_t i = 0; i < count; ++i) joint.move[i] -= step_move * joint.border_move[i];
    }
    const double share = find_share(spline, boxes, step_move);
    if (!std::isfinite(share * step_move)) return true;
    is_full = share == 1;
    spline.step_s += share * step_move;
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      for (std::size_t i = 0; i < count; ++i) spline.points[j][i] += share * joints_[j].move[i];
    }
  }
  return is_full;
}

}  // namespace mneme::internal
