// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Random paths and limits, and what may be wrong with a trajectory, by code that shares nothing
/// with the one that made it.
#pragma once

#include "mneme/trajectory.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace mneme::test {

/// Uniform waypoints; some paths have steps of all sizes, reversals, straight corners and doubled
/// waypoints.
inline Path random_path(const Robot& robot, Rng& rng) {
  const auto uniform = [&] {
    Configuration q;
    for (int i = 0; i < robot.joint_count(); ++i) {
      q.push_back(rng.uniform(robot.group_joint(i).lower, robot.group_joint(i).upper));
    }
    return robot.normalized(q);
  };
  const auto count = 2 + rng.index(12);
  const bool is_odd = rng.index(2) == 0;
  Path path = {uniform()};
  while (path.size() < count) {
    Configuration next = uniform();
    const Configuration delta = robot.difference(path.back(), next);
    const auto kind = is_odd ? rng.index(6) : 0;
    const double share = kind == 1   ? std::pow(10, rng.uniform(-9, 0))  // a short step
                         : kind == 2 ? rng.uniform(0, 0.5)               // halfway, then on
                         : kind == 3 ? 0                                 // the same waypoint
                                     : 1;
    for (std::size_t j = 0; j < next.size(); ++j) next[j] = path.back()[j] + share * delta[j];
    if (kind == 4 && path.size() > 1) next = path[path.size() - 2];  // back
    path.push_back(robot.normalized(next));
    if (kind != 2) continue;
    for (std::size_t j = 0; j < next.size(); ++j) next[j] += share * delta[j];
    path.push_back(robot.normalized(next));
  }
  return path;
}

/// Limits over several orders of magnitude; none of jerk.
inline RateLimits random_limits(const Robot& robot, Rng& rng) {
  RateLimits limits;
  const double velocity = rng.uniform(-2, 2), acceleration = rng.uniform(-2, 2);
  for (int i = 0; i < robot.joint_count(); ++i) {
    limits.velocity.push_back(std::pow(10, velocity + rng.uniform(-1, 1)));
    limits.acceleration.push_back(std::pow(10, acceleration + rng.uniform(-1, 1)));
  }
  return limits;
}

/// Adds limits of jerk whose times are of the order of the others'; now and then a
/// joint has none.
inline RateLimits random_jerk_limits(const Robot& robot, Rng& rng) {
  RateLimits limits = random_limits(robot, rng);
  const double time_s =
      limits.velocity[0] / limits.acceleration[0] * std::pow(10, rng.uniform(-3, 1));
  for (const double acceleration : limits.acceleration) {
    const bool has_none = rng.index(8) == 0;
    const double jerk = acceleration / time_s * std::pow(10, rng.uniform(-1, 1));
    limits.jerk.push_back(has_none ? std::numeric_limits<double>::infinity()
                                   : std::clamp(jerk, 1e-5, 1e7));
  }
  return limits;
}

/// The path with continuous joints unwrapped.
inline Path unwrapped(const Robot& robot, const Path& path) {
  Path result = {path.front()};
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Configuration delta = robot.difference(path[i - 1], path[i]);
    result.push_back(result.back());
    for (std::size_t j = 0; j < delta.size(); ++j) result.back()[j] += delta[j];
  }
  return result;
}

/// L2 joint distance from `q` to the nearest point of `path`, which is unwrapped.
inline double distance_to(const Path& path, const Configuration& q) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Configuration& a = path[i == 0 ? 0 : i - 1];
    double along = 0, length = 0, sum = 0;
    for (std::size_t j = 0; j < q.size(); ++j) {
      along += (q[j] - a[j]) * (path[i][j] - a[j]);
      length += (path[i][j] - a[j]) * (path[i][j] - a[j]);
    }
    const double share = length > 0 ? std::clamp(along / length, 0.0, 1.0) : 0;
    for (std::size_t j = 0; j < q.size(); ++j) {
      const double away = q[j] - a[j] - share * (path[i][j] - a[j]);
      sum += away * away;
    }
    least = std::min(least, std::sqrt(sum));
  }
  return least;
}

/// By how much the greatest of `values` exceeds its limit, as a fraction of that.
inline double excess(const std::vector<double>& values, const std::vector<double>& limits) {
  double most = -1;
  for (std::size_t j = 0; j < values.size(); ++j) {
    most = std::max(most, std::abs(values[j]) / limits[j] - 1);
  }
  return most;
}

inline double largest(const std::vector<double>& values) {
  double most = 0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

/// By how much jerk exceeds its limit between two points, as a fraction of that.
inline double jerk_excess(const Trajectory::Point& from, const Trajectory::Point& to,
                          const RateLimits& limits) {
  double most = -1;
  for (std::size_t j = 0; j < limits.jerk.size(); ++j) {
    const double rounding = 1e-7 * limits.acceleration[j];
    const double change = std::abs(to.acceleration[j] - from.acceleration[j]) - rounding;
    most = std::max(most, change / (to.time_s - from.time_s) / limits.jerk[j] - 1);
  }
  return most;
}

/// The first thing that is wrong, or nothing: limits beyond 1e-6, values that are not finite, a
/// jump, ends that are not the path's or not at rest (at `start_velocity`, if there is one), a
/// point farther from the path than `tolerance`. Looks at 500 times.
inline std::optional<std::string> trajectory_flaw(const Robot& robot, const Path& path,
                                                  const RateLimits& limits, double tolerance,
                                                  const Trajectory& trajectory,
                                                  std::vector<double> start_velocity = {}) {
  constexpr int count = 500;
  constexpr double kLimit = 1e-6, kPlace = 3e-6;
  const double duration = trajectory.duration_s();
  if (!std::isfinite(duration)) return "the duration is not finite";
  const Path way = unwrapped(robot, path);
  start_velocity.resize(path.front().size());
  Trajectory::Point last = trajectory.at(-1);
  last.velocity = start_velocity;
  if (distance_to({way.front()}, last.position) > kPlace) return "it begins elsewhere";
  if (distance_to({way.back()}, trajectory.at(duration).position) > kPlace)
    return "it ends elsewhere";
  for (int i = 0; i <= count; ++i) {
    const Trajectory::Point point = trajectory.at(i < count ? duration * i / count : duration);
    const auto flaw = [&](const std::string& what) {
      return fmt::format("at {} of {} s: {}", point.time_s, duration, what);
    };
    const double speed = excess(point.velocity, limits.velocity);
    const double acceleration = excess(point.acceleration, limits.acceleration);
    // Written so that a NaN is a flaw.
    if (!(speed <= kLimit)) return flaw(fmt::format("velocity exceeds by {}", speed));
    if (!(acceleration <= kLimit)) return flaw(fmt::format("acceleration by {}", acceleration));
    for (const double share : {0.01, 1.0}) {
      const double jerk =
          jerk_excess(point, trajectory.at(point.time_s + share * duration / count), limits);
      if (duration > 0 && !(jerk <= kLimit)) return flaw(fmt::format("jerk by {}", jerk));
    }
    const double away = distance_to(way, point.position);
    if (!(away <= tolerance + kPlace)) return flaw(fmt::format("{} off the path", away));
    const double dt = i == 0 ? 0 : duration / count;
    for (std::size_t j = 0; j < point.position.size(); ++j) {
      const double step = std::abs(point.position[j] - last.position[j]);
      const double change = std::abs(point.velocity[j] - last.velocity[j]);
      if (step > limits.velocity[j] * dt * (1 + kLimit) + kPlace) return flaw("position jumps");
      if (change > (limits.acceleration[j] * dt + limits.velocity[j] * kLimit) * (1 + kLimit)) {
        return flaw(fmt::format("velocity jumps by {}", change));
      }
    }
    last = point;
  }
  return std::nullopt;
}

}  // namespace mneme::test
