// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/trajectory.h"

#include "base/check_ranges.h"
#include "trajectory/rate_limits.h"
#include "trajectory/rounded_path.h"
#include "trajectory/speed_profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace mneme {
namespace {

constexpr double kMostPoints = 1e7;

/// The end of a trajectory that is not longer than this fraction of a step is its last point.
constexpr double kLeastStep = 1e-6;

Result<void> check_path(const Robot& robot, const Path& path) {
  if (path.empty()) return fail(ErrorCode::invalid, "a path without configurations has no timing");
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (auto flaw = robot.describe_violation(path[i], fmt::format("waypoint {}", i + 1))) {
      return fail(ErrorCode::invalid, *std::move(flaw));
    }
  }
  return {};
}

}  // namespace

Trajectory::Trajectory(std::vector<Stretch> stretches, Configuration end, double duration_s)
    : stretches_(std::move(stretches)), end_(std::move(end)), duration_s_(duration_s) {}

Trajectory::Point Trajectory::at(double time_s) const {
  const std::vector<double> still(end_.size(), 0.0);
  if (stretches_.empty() || time_s >= duration_s_) return {time_s, end_, still, still};
  if (time_s < 0) return {time_s, stretches_.front().begin, still, still};
  const auto after = std::ranges::upper_bound(stretches_, time_s, {}, &Stretch::begin_s);
  const Stretch& stretch = *std::prev(after);
  const double t = time_s - stretch.begin_s;
  const double s = (stretch.speed + 0.5 * stretch.acceleration * t) * t;
  const double speed = stretch.speed + stretch.acceleration * t;
  Point point{time_s, stretch.begin, still, still};
  for (std::size_t j = 0; j < end_.size(); ++j) {
    const double bend = stretch.bend.empty() ? 0 : stretch.bend[j];
    const double slope = stretch.direction[j] + bend * s;
    point.position[j] += (stretch.direction[j] + 0.5 * bend * s) * s;
    point.velocity[j] = slope * speed;
    point.acceleration[j] = slope * stretch.acceleration + bend * speed * speed;
  }
  return point;
}

Result<std::vector<Trajectory::Point>> Trajectory::sample(double dt) const {
  if (!(dt > 0) || !std::isfinite(dt)) {
    return fail(ErrorCode::invalid, fmt::format("dt is {}; expected seconds above 0", dt));
  }
  if (!(duration_s_ / dt < kMostPoints)) {
    return fail(ErrorCode::invalid,
                fmt::format("a point every {} s of a trajectory of {} s would be more than {} "
                            "points; a larger dt gives fewer",
                            dt, duration_s_, kMostPoints));
  }
  std::vector<Point> points;
  const int steps = static_cast<int>(std::ceil(duration_s_ / dt - kLeastStep));
  for (int i = 0; i < steps; ++i) points.push_back(at(i * dt));
  points.push_back(at(duration_s_));
  return points;
}

Result<Trajectory> parameterize(const Robot& robot, const Path& path, const RateLimits& limits,
                                const TrajectorySettings& settings,
                                const MotionVerifier* verifier) {
  if (auto checked = check_path(robot, path); !checked) return tl::unexpected(checked.error());
  if (auto checked = internal::check_rate_limits(robot, limits); !checked) {
    return tl::unexpected(checked.error());
  }
  if (auto checked = internal::check_ranges(settings); !checked) {
    return tl::unexpected(checked.error());
  }
  return internal::follow_fastest(
      internal::round_corners(robot, path, settings.path_tolerance, verifier), limits);
}

}  // namespace mneme
