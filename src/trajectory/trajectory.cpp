// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/trajectory.h"

#include "base/check_ranges.h"
#include "base/threads.h"
#include "check/end_motions.h"
#include "trajectory/rounded_path.h"
#include "trajectory/speed_profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace mneme {
namespace {

constexpr double kMostPoints = 1e7;
constexpr double kNanosecondsPerSecond = 1e9;

Result<void> check_path(const Robot& robot, const Path& path) {
  if (path.empty()) return fail(ErrorCode::invalid, "a path without configurations has no timing");
  constexpr double kAny = std::numeric_limits<double>::infinity();
  const bool may_be_outside =
      path.size() > 1 && internal::is_near_limits(robot, path.front(), {kAny, kAny, 0, 0});
  for (std::size_t i = may_be_outside ? 1 : 0; i < path.size(); ++i) {
    if (auto flaw = robot.describe_violation(path[i], fmt::format("waypoint {}", i + 1))) {
      return fail(ErrorCode::invalid, *std::move(flaw));
    }
  }
  return {};
}

/// The whole turns of continuous joints at `q`, radians.
Configuration whole_turns(const Robot& robot, const Configuration& q) {
  const Configuration inside = robot.normalized(q);
  Configuration turns(q.size(), 0.0);
  for (std::size_t j = 0; j < q.size(); ++j) {
    const bool wraps = robot.group_joint(static_cast<int>(j)).type == JointType::continuous;
    if (wraps) turns[j] = q[j] - inside[j];
  }
  return turns;
}

/// The same path from the turn in [-pi, pi) on: many turns would lose digits in single precision.
Path without_turns(const Robot& robot, Path path, const Configuration& turns) {
  for (std::size_t j = 0; j < turns.size(); ++j) path.front()[j] -= turns[j];
  const Configuration start = path.front();
  return unwrapped(robot, std::move(path), start);
}

}  // namespace

Trajectory::Trajectory(std::vector<Stretch> stretches, Configuration end, double end_s,
                       double window_s)
    : stretches_(std::move(stretches)), end_(std::move(end)), end_s_(end_s), window_s_(window_s) {
  if (window_s_ == 0) return;
  for (const Stretch& stretch : stretches_) {
    integrals_.push_back(integrals_.empty() ? std::vector<double>(end_.size(), 0.0)
                                            : integral(stretch.begin_s));
  }
}

double Trajectory::duration_s() const {
  // Rounding of the product must not add a nanosecond.
  constexpr double kRounding = 1e-5;
  const double nanoseconds = (end_s_ + window_s_) * kNanosecondsPerSecond;
  return std::ceil(nanoseconds - kRounding) / kNanosecondsPerSecond;
}

void Trajectory::shift(const Configuration& offset) {
  for (std::size_t j = 0; j < end_.size(); ++j) {
    for (Stretch& stretch : stretches_) stretch.begin[j] += offset[j];
    end_[j] += offset[j];
  }
}

Trajectory::Point Trajectory::follow(double time_s) const {
  const std::vector<double> still(end_.size(), 0.0);
  if (stretches_.empty() || time_s >= end_s_) return {time_s, end_, still, still};
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

std::vector<double> Trajectory::integral(double time_s) const {
  std::vector<double> sum(end_.size(), 0.0);
  if (stretches_.empty()) return sum;
  // The last stretch that has begun and whose integral is known.
  const double until = std::min(time_s, end_s_);
  const auto after =
      std::ranges::upper_bound(stretches_.begin(), stretches_.begin() + std::ssize(integrals_),
                               until, {}, &Stretch::begin_s);
  const auto i =
      static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - stretches_.begin(), 1) - 1);
  const Stretch& stretch = stretches_[i];
  const double t = until - stretch.begin_s;
  const double v = stretch.speed, a = stretch.acceleration;
  const double once = until < 0 ? 0 : (v / 2 + a * t / 6) * t * t;
  const double twice = until < 0 ? 0 : (v * v / 3 + (v / 4 + a * t / 20) * a * t) * t * t * t;
  for (std::size_t j = 0; j < sum.size(); ++j) {
    const double bend = stretch.bend.empty() ? 0 : stretch.bend[j];
    sum[j] = integrals_[i][j] + (stretch.begin[j] - end_[j]) * t + stretch.direction[j] * once +
             0.5 * bend * twice;
  }
  return sum;
}

Trajectory::Point Trajectory::at(double time_s) const {
  const std::vector<double> still(end_.size(), 0.0);
  if (time_s >= duration_s()) return {time_s, end_, still, still};
  Point point = follow(time_s);
  if (window_s_ == 0) return point;
  const Point before = follow(time_s - window_s_);
  const std::vector<double> from = integral(time_s - window_s_), to = integral(time_s);
  for (std::size_t j = 0; j < end_.size(); ++j) {
    point.acceleration[j] = (point.velocity[j] - before.velocity[j]) / window_s_;
    point.velocity[j] = (point.position[j] - before.position[j]) / window_s_;
    point.position[j] = end_[j] + (to[j] - from[j]) / window_s_;
  }
  return point;
}

Result<std::vector<Trajectory::Point>> Trajectory::sample(double dt) const {
  if (!(dt > 0) || !std::isfinite(dt)) {
    return fail(ErrorCode::invalid, "dt is {}; expected seconds above 0", dt);
  }
  if (!(duration_s() / dt < kMostPoints)) {
    return fail(ErrorCode::invalid,
                "a point every {} s of a trajectory of {} s gives more than {} points; choose a "
                "larger dt",
                dt, duration_s(), kMostPoints);
  }
  std::vector<Point> points;
  const double duration = duration_s();
  const int steps = duration > 0 ? std::max(1, static_cast<int>(std::lround(duration / dt))) : 0;
  for (int i = 0; i < steps; ++i) {
    constexpr int kPollInterval = 1024;
    if (i % kPollInterval == 0) internal::poll_interrupt();
    points.push_back(at(i * dt));
  }
  points.push_back(at(duration));
  return points;
}

Result<Trajectory> parameterize(const Robot& robot, const Path& path, const RateLimits& limits,
                                const TrajectorySettings& settings,
                                const MotionVerifier* verifier) {
  MNEME_TRY(check_path(robot, path));
  MNEME_TRY(internal::check_rate_limits(robot, limits));
  MNEME_TRY(internal::check_ranges(settings));
  // Averaging and rounding each use half of the tolerance.
  const bool is_smooth = internal::has_jerk_limit(limits);
  const double tolerance = is_smooth ? settings.path_tolerance / 2 : settings.path_tolerance;
  const Configuration turns = whole_turns(robot, path.front());
  internal::RoundedPath rounded =
      internal::round_corners(robot, without_turns(robot, path, turns), tolerance, verifier);
  Trajectory motion =
      is_smooth ? internal::follow_smoothly(std::move(rounded), limits, tolerance, verifier)
                : internal::follow_fastest(rounded, limits).motion;
  motion.shift(turns);
  return motion;
}

}  // namespace mneme
