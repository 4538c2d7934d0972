// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The shortest duration of a motion along a rounded path by brute force: thousands of points, at
/// each of which the greatest speed from which the end can be reached is found by bisection. It
/// knows nothing of cells, of lines or of straight curves.
#pragma once

#include "mneme/trajectory.h"

#include "trajectory/rounded_path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace mneme::test {

/// Limits of the joints between two points, where the squared path speed is x and the path
/// acceleration u: |q'| sqrt(x) <= v and |q' u + q'' x| <= a for each joint, also at the second
/// point, where it is x + 2 step u. (Where all slopes vanish in between, as at a reversal, velocity
/// could jump otherwise.)
struct DensePoint {
  std::vector<double> slope, end_slope, bend;
  double step = 0;  ///< to the next point
  bool is_rest = false;

  [[nodiscard]] double most_x(const RateLimits& limits) const {
    double most = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < slope.size(); ++j) {
      if (slope[j] != 0) most = std::min(most, std::pow(limits.velocity[j] / slope[j], 2));
    }
    return most;
  }
  /// Least and most u at x; nothing fits if least > most.
  [[nodiscard]] std::pair<double, double> range(const RateLimits& limits, double x) const {
    double least = -std::numeric_limits<double>::infinity(), most = -least;
    const auto keep = [&](double factor, double push, double rest) {
      if (factor == 0) {
        if (std::abs(push) > rest) least = std::numeric_limits<double>::infinity();
        return;
      }
      const double a = (-rest - push) / factor, b = (rest - push) / factor;
      least = std::max(least, std::min(a, b));
      most = std::min(most, std::max(a, b));
    };
    for (std::size_t j = 0; j < slope.size(); ++j) {
      keep(slope[j], bend[j] * x, limits.acceleration[j]);
      keep(end_slope[j] + 2 * step * bend[j], bend[j] * x, limits.acceleration[j]);
    }
    return {least, most};
  }
};

inline std::vector<DensePoint> dense_points(const internal::RoundedPath& path, int per_curve) {
  std::vector<DensePoint> points;
  for (const internal::Curve& curve : path.curves) {
    const double step = curve.length / per_curve;
    for (int i = 0; i < per_curve; ++i) {
      DensePoint point;
      point.step = step;
      point.is_rest = i == 0 && curve.begins_at_rest;
      for (std::size_t j = 0; j < curve.begin.size(); ++j) {
        point.slope.push_back(curve.slope(j, i * step));
        point.end_slope.push_back(curve.slope(j, (i + 1) * step));
        point.bend.push_back(curve.is_straight() ? 0 : curve.bend[j]);
      }
      points.push_back(std::move(point));
    }
  }
  return points;
}

/// Seconds.
inline double dense_duration(const internal::RoundedPath& path, const RateLimits& limits,
                             int per_curve) {
  const std::vector<DensePoint> points = dense_points(path, per_curve);
  std::vector<double> fastest(points.size() + 1, 0.0);
  for (std::size_t i = points.size(); i-- > 0;) {
    const DensePoint& point = points[i];
    if (point.is_rest) continue;
    const auto can_stop = [&](double x) {
      const auto [least, most] = point.range(limits, x);
      return least <= most && x + 2 * point.step * least <= fastest[i + 1];
    };
    double low = 0, high = point.most_x(limits);
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (low + high);
      (can_stop(middle) ? low : high) = middle;
    }
    fastest[i] = low;
  }
  double time_s = 0, x = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double most = points[i].range(limits, x).second;
    const double next = std::clamp(x + 2 * points[i].step * most, 0.0, fastest[i + 1]);
    time_s += 2 * points[i].step / (std::sqrt(x) + std::sqrt(next));
    x = next;
  }
  return time_s;
}

}  // namespace mneme::test
