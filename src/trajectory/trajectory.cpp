// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/trajectory.h"

#include "base/check_ranges.h"
#include "base/threads.h"
#include "check/end_motions.h"
#include "trajectory/follow_path.h"
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

/// Changes the coefficients of polynomials in time to those of the same motion from `later_s` on.
void begin_later(std::vector<double>& coefficients, std::size_t joints, double later_s) {
  for (std::size_t first = 0; first < coefficients.size(); first += joints) {
    for (std::size_t i = coefficients.size() - joints; i-- > first;) {
      coefficients[i] += later_s * coefficients[i + joints];
    }
  }
}

}  // namespace

Trajectory::Trajectory(std::vector<Stretch> stretches, Configuration end, double end_s,
                       std::vector<double> end_velocity)
    : stretches_(std::move(stretches)),
      end_(std::move(end)),
      end_s_(end_s),
      end_velocity_(std::move(end_velocity)) {
  end_velocity_.resize(end_.size());
}

double Trajectory::duration_s() const {
  // Rounding of the product must not add a nanosecond.
  constexpr double kRounding = 1e-5;
  const double nanoseconds = end_s_ * kNanosecondsPerSecond;
  return std::max(0.0, std::ceil(nanoseconds - kRounding)) / kNanosecondsPerSecond;
}

void Trajectory::shift(const Configuration& offset) {
  for (std::size_t j = 0; j < end_.size(); ++j) {
    for (Stretch& stretch : stretches_) stretch.coefficients[j] += offset[j];
    end_[j] += offset[j];
  }
}

Trajectory::Point Trajectory::at(double time_s) const {
  const std::size_t joints = end_.size();
  Point point{time_s, end_, std::vector<double>(joints), std::vector<double>(joints)};
  const double duration = duration_s();  // by rounding, it may be less than end_s_
  if (stretches_.empty() || time_s >= std::min(end_s_, duration)) {
    if (time_s <= duration) point.velocity = end_velocity_;
    return point;
  }
  std::ranges::fill(point.position, 0);
  const auto after = std::ranges::upper_bound(stretches_, time_s, {}, &Stretch::begin_s);
  const Stretch& stretch = after == stretches_.begin() ? *after : *std::prev(after);
  const double t = std::max(0.0, time_s - stretch.begin_s);
  for (std::size_t first = stretch.coefficients.size(); first > 0;) {
    first -= joints;
    for (std::size_t j = 0; j < joints; ++j) {
      point.acceleration[j] = point.acceleration[j] * t + 2 * point.velocity[j];
      point.velocity[j] = point.velocity[j] * t + point.position[j];
      point.position[j] = point.position[j] * t + stretch.coefficients[first + j];
    }
  }
  if (time_s < 0) {
    std::ranges::fill(point.velocity, 0);
    std::ranges::fill(point.acceleration, 0);
  }
  return point;
}

Trajectory Trajectory::between(double from_s, double to_s) const {
  from_s = std::clamp(from_s, 0.0, end_s_);
  to_s = std::clamp(to_s, from_s, end_s_);
  std::vector<Stretch> stretches;
  for (std::size_t i = 0; i < stretches_.size(); ++i) {
    const double begin_s = stretches_[i].begin_s;
    const double end_s = i + 1 < stretches_.size() ? stretches_[i + 1].begin_s : end_s_;
    if (end_s <= from_s || begin_s >= to_s) continue;
    const double later_s = std::max(0.0, from_s - begin_s);
    stretches.push_back({begin_s + later_s - from_s, stretches_[i].coefficients});
    if (later_s > 0) begin_later(stretches.back().coefficients, end_.size(), later_s);
  }
  Point end = at(to_s);
  return {std::move(stretches), std::move(end.position), to_s - from_s, std::move(end.velocity)};
}

Trajectory Trajectory::of_joint(std::size_t joint) const {
  std::vector<Stretch> stretches = stretches_;
  for (Stretch& stretch : stretches) {
    std::vector<double> own;
    for (std::size_t i = joint; i < stretch.coefficients.size(); i += end_.size()) {
      own.push_back(stretch.coefficients[i]);
    }
    stretch.coefficients = std::move(own);
  }
  return {std::move(stretches), {end_[joint]}, end_s_, {end_velocity_[joint]}};
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
  points.reserve(static_cast<std::size_t>(steps) + 1);
  for (int i = 0; i < steps; ++i) {
    constexpr int kPollInterval = 1024;
    if (i % kPollInterval == 0) internal::poll_interrupt();
    points.push_back(at(i * dt));
  }
  points.push_back(at(duration));
  return points;
}

Result<Trajectory> parameterize(const Robot& robot, const Path& path, const RateLimits& limits,
                                const TrajectorySettings& settings, const MotionVerifier* verifier,
                                const std::vector<double>& start_velocity,
                                const std::vector<double>& end_velocity) {
  MNEME_TRY(check_path(robot, path));
  MNEME_TRY(internal::check_rate_limits(robot, limits));
  MNEME_TRY(internal::check_ranges(settings));
  const Configuration turns = whole_turns(robot, path.front());
  const Path near = without_turns(robot, path, turns);
  internal::Timing timing{robot, limits, settings, verifier};
  Trajectory motion =
      MNEME_TRY(internal::follow_path(timing, near, {start_velocity, end_velocity}));
  motion.shift(turns);
  return motion;
}

}  // namespace mneme
