// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The shortest duration of a motion along a given curve with limits of velocity, acceleration and
/// jerk, by brute force: dynamic programming over arc length, path speed and path acceleration. It
/// knows nothing of legs, corners or splines. Accurate to some percent: its steps
/// are the more wasteful the coarser the grid is.
#pragma once

#include "mneme/trajectory.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace mneme::test {

/// A part of a curve: derivatives by arc length at its middle, one value per joint.
struct CurvePart {
  double length = 0;
  std::vector<double> first, second, third;
};

inline double speed_of(const Trajectory::Point& point) {
  double sum = 0;
  for (const double v : point.velocity) sum += v * v;
  return std::sqrt(sum);
}

/// Returns `count` parts, shorter near both ends. Derivatives are finite differences of positions:
/// they know nothing of how fast the motion is.
inline std::vector<CurvePart> sample_curve(const Trajectory& motion, int count) {
  constexpr int kTimes = 20000;
  const double dt = motion.duration_s() / kTimes;
  std::vector<double> arc = {0};
  for (int i = 1; i <= kTimes; ++i) {
    arc.push_back(arc.back() + dt * speed_of(motion.at((i - 0.5) * dt)));
  }
  const auto position_at = [&](double s) {
    const auto after = std::upper_bound(arc.begin() + 1, arc.end() - 1, s);
    const double share = (s - *(after - 1)) / std::max(*after - *(after - 1), 1e-15);
    const auto i = static_cast<double>(after - arc.begin() - 1);
    return motion.at((i + std::clamp(share, 0.0, 1.0)) * dt).position;
  };
  const double whole = arc.back(), h = whole / 200;
  const auto begin_of = [&](int i) { return whole * (0.5 - 0.5 * std::cos(M_PI * i / count)); };
  std::vector<CurvePart> parts;
  for (int i = 0; i < count; ++i) {
    // Both ends are straight.
    const double s = std::clamp(0.5 * (begin_of(i) + begin_of(i + 1)), 1.5 * h, whole - 1.5 * h);
    const Configuration a = position_at(s - 1.5 * h), b = position_at(s - 0.5 * h);
    const Configuration c = position_at(s + 0.5 * h), d = position_at(s + 1.5 * h);
    CurvePart part{begin_of(i + 1) - begin_of(i), {}, {}, {}};
    for (std::size_t j = 0; j < a.size(); ++j) {
      part.first.push_back((c[j] - b[j]) / h);
      part.second.push_back((d[j] - c[j] - b[j] + a[j]) / (2 * h * h));
      part.third.push_back((d[j] - 3 * c[j] + 3 * b[j] - a[j]) / (h * h * h));
    }
    parts.push_back(std::move(part));
  }
  return parts;
}

/// Grids of path speed, finer near rest, and of path acceleration.
class ThirdOrderProfile {
 public:
  ThirdOrderProfile(const std::vector<CurvePart>& curve, const RateLimits& limits, int speeds,
                    int accelerations)
      : curve_(curve), limits_(limits), speeds_(speeds), accelerations_(accelerations) {
    for (const CurvePart& part : curve) {
      most_speed_ = std::max(most_speed_, most(part.first, limits.velocity));
      most_acceleration_ = std::max(most_acceleration_, most(part.first, limits.acceleration));
    }
  }

  /// Seconds from rest to rest; infinite if the grid is too coarse. The first and the last part are
  /// passed at constant jerk: from rest, speed and acceleration are then given by the length.
  [[nodiscard]] double duration() const {
    const double never = std::numeric_limits<double>::infinity();
    const RestPart first = rest_part(curve_.front()), last = rest_part(curve_.back());
    std::vector<double> next(index(speeds_, 0), never);
    for (int v = 0; v < speeds_; ++v) {
      for (int a = 0; a <= 2 * accelerations_; ++a) {
        if (last.is_near(speed(v), -acceleration(a))) next[index(v, a)] = last.time_s;
      }
    }
    for (std::size_t i = curve_.size() - 1; i-- > 1;) {
      std::vector<double> now(next.size(), never);
      for (int v = 0; v < speeds_; ++v) {
        for (int a = 0; a <= 2 * accelerations_; ++a) now[index(v, a)] = best(i, v, a, next);
      }
      next = std::move(now);
    }
    return first.time_s + value(first.speed, first.acceleration, next);
  }

 private:
  static constexpr int kJerks = 10;

  /// A part from rest at constant jerk, and what is then reached.
  struct RestPart {
    double time_s = 0, speed = 0, acceleration = 0;

    [[nodiscard]] bool is_near(double v, double a) const {
      return std::abs(v - speed) < 0.3 * speed && std::abs(a - acceleration) < 0.3 * acceleration;
    }
  };
  [[nodiscard]] RestPart rest_part(const CurvePart& part) const {
    const double jerk = most(part.first, limits_.jerk);
    const double time_s = std::cbrt(6 * part.length / jerk);
    return {time_s, jerk * time_s * time_s / 2, jerk * time_s};
  }

  static double most(const std::vector<double>& slope, const std::vector<double>& limits) {
    double most = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < slope.size(); ++j) {
      if (slope[j] != 0) most = std::min(most, limits[j] / std::abs(slope[j]));
    }
    return most;
  }
  [[nodiscard]] std::size_t index(int v, int a) const {
    return static_cast<std::size_t>(v * (2 * accelerations_ + 1) + a);
  }
  [[nodiscard]] double speed(double v) const {
    return most_speed_ * std::pow(v / (speeds_ - 1), 2);
  }
  [[nodiscard]] double acceleration(double a) const {
    return most_acceleration_ * (a / accelerations_ - 1);
  }
  [[nodiscard]] bool keeps_limits(const CurvePart& p, double v, double a, double jerk) const {
    constexpr double kSlack = 1.002;  // of the grid
    for (std::size_t j = 0; j < p.first.size(); ++j) {
      if (std::abs(p.first[j] * v) > kSlack * limits_.velocity[j]) return false;
      const double own = p.first[j] * a + p.second[j] * v * v;
      if (std::abs(own) > kSlack * limits_.acceleration[j]) return false;
      const double change = p.first[j] * jerk + 3 * p.second[j] * v * a + p.third[j] * v * v * v;
      if (std::abs(change) > kSlack * limits_.jerk[j]) return false;
    }
    return true;
  }

  /// Least time from a node at part `i` to the end, over jerks that are constant within the part.
  [[nodiscard]] double best(std::size_t i, int v, int a, const std::vector<double>& next) const {
    const CurvePart& part = curve_[i];
    const double jerk = most(part.first, limits_.jerk);
    double least = std::numeric_limits<double>::infinity();
    for (int k = -kJerks; k <= kJerks; ++k) {
      least = std::min(least, through(part, speed(v), acceleration(a), jerk * k / kJerks, next));
    }
    return least;
  }

  [[nodiscard]] double through(const CurvePart& part, double v, double a, double jerk,
                               const std::vector<double>& next) const {
    const double never = std::numeric_limits<double>::infinity();
    const auto passed = [&](double t) { return t * (v + t * (a / 2 + t * jerk / 6)); };
    const auto speed_at = [&](double t) { return v + t * (a + t * jerk / 2); };
    double low = 0, high = 1e-5;
    while (passed(high) < part.length) {
      if (speed_at(high) < 0 || high > 10) return never;
      low = high;
      high *= 2;
    }
    for (int k = 0; k < 16; ++k) {
      const double middle = 0.5 * (low + high);
      (passed(middle) < part.length ? low : high) = middle;
    }
    const double end_speed = std::max(0.0, speed_at(high)), end = a + high * jerk;
    const double half = high / 2;
    if (!keeps_limits(part, v, a, jerk) || !keeps_limits(part, end_speed, end, jerk) ||
        !keeps_limits(part, std::max(0.0, speed_at(half)), a + half * jerk, jerk)) {
      return never;
    }
    return high + value(end_speed, end, next);
  }

  /// Bilinear between nodes; nodes that cannot reach the end count as the others around.
  [[nodiscard]] double value(double v, double a, const std::vector<double>& next) const {
    const double row = std::sqrt(v / most_speed_) * (speeds_ - 1);
    const double column = (a / most_acceleration_ + 1) * accelerations_;
    const int v0 = std::clamp(static_cast<int>(row), 0, speeds_ - 2);
    const int a0 = std::clamp(static_cast<int>(column), 0, 2 * accelerations_ - 1);
    double sum = 0, weights = 0;
    for (int dv = 0; dv <= 1; ++dv) {
      for (int da = 0; da <= 1; ++da) {
        const double time_s = next[index(v0 + dv, a0 + da)];
        const double weight = std::max(0.0, 1 - std::abs(row - v0 - dv)) *
                              std::max(0.0, 1 - std::abs(column - a0 - da));
        if (!std::isfinite(time_s)) continue;
        sum += weight * time_s;
        weights += weight;
      }
    }
    constexpr double kEnough = 0.25;
    return weights > kEnough ? sum / weights : std::numeric_limits<double>::infinity();
  }

  const std::vector<CurvePart>& curve_;
  const RateLimits& limits_;
  int speeds_, accelerations_;
  double most_speed_ = 0, most_acceleration_ = 0;
};

}  // namespace mneme::test
