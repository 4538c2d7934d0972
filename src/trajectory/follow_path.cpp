// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "trajectory/follow_path.h"

#include "base/as_index.h"
#include "base/fail.h"
#include "trajectory/rounded_path.h"
#include "trajectory/shorten_time.h"
#include "trajectory/smooth_motion.h"
#include "trajectory/speed_profile.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace mneme {
namespace internal {
namespace {

/// Stops are longer by this share, so that rounding does not make a leg too short for its stop.
constexpr double kStopRoom = 1e-7;
/// Continuous joints turn by less than pi by this, as verification wants it.
constexpr double kTurnRoom = 1e-3;
/// Largest part of a start velocity across the first leg, as a share of the speed, and rounding of
/// the leg's ends.
constexpr double kMostAcross = 1e-6, kRoundingOfEnds = 1e-14;

Result<void> check_velocity(const Robot& robot, const std::vector<double>& velocity,
                            const RateLimits& limits) {
  constexpr double kSlack = 1e-9;  // of rounding
  if (velocity.size() != as_index(robot.joint_count())) {
    return fail(ErrorCode::invalid,
                "start velocity: got {} values, expected {}: one for each joint in the group of "
                "robot '{}'",
                velocity.size(), robot.joint_count(), robot.name());
  }
  for (std::size_t j = 0; j < velocity.size(); ++j) {
    // Written so that a NaN is refused.
    if (std::abs(velocity[j]) <= limits.velocity[j] * (1 + kSlack)) continue;
    return fail(ErrorCode::invalid,
                "start velocity: joint '{}' moves at {:.4g}, faster than its limit {:.4g}",
                robot.group_joint(static_cast<int>(j)).name, velocity[j], limits.velocity[j]);
  }
  return {};
}

std::vector<double> unit(const std::vector<double>& v) {
  return plus(std::vector<double>(v.size()), 1 / norm(v), v);
}

/// `second` after the pieces, which end at its begin.
Trajectory join(const std::vector<JerkPiece>& pieces, const Trajectory& second) {
  const Trajectory first = to_trajectory(pieces, {});
  std::vector<Trajectory::Stretch> stretches = first.stretches();
  double begin_s = 0;
  for (const JerkPiece& piece : pieces) begin_s += piece.duration_s;
  for (Trajectory::Stretch stretch : second.stretches()) {
    stretch.begin_s += begin_s;
    stretches.push_back(std::move(stretch));
  }
  return {std::move(stretches), second.at(second.duration_s()).position,
          begin_s + second.duration_s()};
}

/// Stops on the first leg, and continues from there.
Trajectory stop_first(const Timing& timing, const Path& path, const Leg& leg, double speed) {
  const double length =
      std::min(leg.length, (1 + kStopRoom) * reach_to_stop(leg.direction, speed, timing.limits));
  Path rest = path;
  rest.front() = plus(leg.begin, length, leg.direction);
  const Legs stop{{{leg.begin, leg.direction, length}}, rest.front()};
  return join(follow_legs(stop, timing.limits, {0, true, speed}, nullptr),
              follow_from_rest(timing, rest));
}

}  // namespace

Trajectory follow_from_rest(const Timing& timing, const Path& path) {
  const Robot& robot = timing.robot;
  const RateLimits& limits = timing.limits;
  const TrajectorySettings& settings = timing.settings;
  const MotionVerifier* verifier = timing.verifier;
  const Legs legs = find_legs(robot, path);
  FollowSettings following{settings.path_tolerance, begins_outside(robot, path)};
  const bool has_rounds = verifier != nullptr && !following.stops_first && settings.time_rounds > 0;
  const auto follow = [&] {
    return has_jerk_limit(limits)
               ? to_trajectory(follow_legs(legs, limits, following, verifier), legs.end)
               : follow_fastest(round_corners(robot, path, settings.path_tolerance, verifier),
                                limits);
  };
  if (!has_rounds) return follow();
  // Rounds mostly leave the corners, so that those with jerk limits are proven only if they remain.
  following.is_guide = true;
  const Trajectory guide = follow();
  if (auto faster = shorten_time(robot, guide, legs, limits, settings, *verifier)) {
    return *std::move(faster);
  }
  following.is_guide = false;
  return has_jerk_limit(limits) ? follow() : guide;
}

Result<Trajectory> follow_from_velocity(const Timing& timing, const Path& path,
                                        const std::vector<double>& velocity) {
  const auto& [robot, limits, settings, verifier] = timing;
  MNEME_TRY(check_velocity(robot, velocity, limits));
  const Legs legs = find_legs(robot, path);
  const double speed = norm(velocity);
  if (reach_to_stop(unit(velocity), speed, limits) < kLeastStop) {
    return follow_from_rest(timing, path);
  }
  if (legs.legs.empty()) {
    return fail(ErrorCode::invalid,
                "start velocity: the path does not move, expected a stop on it");
  }
  const Leg& first = legs.legs.front();
  const double across = std::max(kMostAcross, kRoundingOfEnds / first.length);
  if (norm(plus(velocity, -speed, first.direction)) > across * speed) {
    return fail(ErrorCode::invalid,
                "start velocity: expected it along the path's first motion; solve() plans such "
                "paths from problems with a start velocity");
  }
  const double reach = reach_to_stop(first.direction, speed, limits);
  if (reach > first.length) {
    return fail(ErrorCode::invalid,
                "start velocity: a stop takes {:.4g} (L2 joint distance), and the path's first "
                "motion is {:.4g} long",
                reach, first.length);
  }
  const FollowSettings passing{settings.path_tolerance, begins_outside(robot, path), speed};
  const Trajectory direct = to_trajectory(follow_legs(legs, limits, passing, verifier), legs.end);
  const Trajectory stopped = stop_first(timing, path, first, speed);
  return direct.duration_s() < stopped.duration_s() ? direct : stopped;
}

}  // namespace internal

double estimate_duration(const Robot& robot, const Path& path, const RateLimits& limits,
                         const MotionVerifier* verifier) {
  if (path.empty()) return 0;
  internal::FollowSettings settings;
  settings.tolerance = TrajectorySettings().path_tolerance;
  settings.is_estimate = settings.is_guide = true;
  return internal::duration_along(internal::find_legs(robot, path), limits, settings, verifier);
}

Result<Configuration> stopping_point(const Robot& robot, const Configuration& start,
                                     const std::vector<double>& velocity,
                                     const RateLimits& limits) {
  MNEME_TRY(internal::check_rate_limits(robot, limits));
  MNEME_TRY(internal::check_velocity(robot, velocity, limits));
  const double speed = internal::norm(velocity);
  if (speed == 0) return start;
  const std::vector<double> direction = internal::unit(velocity);
  const double length = internal::reach_to_stop(direction, speed, limits);
  if (length < kLeastStop) return start;
  Configuration stop = internal::plus(start, (1 + internal::kStopRoom) * length, direction);
  for (std::size_t j = 0; j < stop.size(); ++j) {
    const Joint& joint = robot.group_joint(static_cast<int>(j));
    const double turn = std::abs(stop[j] - start[j]);
    if (joint.type == JointType::continuous) {
      if (turn < std::numbers::pi - internal::kTurnRoom) continue;
      return fail(ErrorCode::invalid,
                  "start velocity: joint '{}' would turn by {:.4g} before it stops, expected less "
                  "than pi: lower the velocity or raise the limits",
                  joint.name, turn);
    }
    if (stop[j] >= joint.lower && stop[j] <= joint.upper) continue;
    return fail(ErrorCode::invalid,
                "start velocity: joint '{}' would stop at {:.4g}, beyond its limit {:.4g}: {:.4g} "
                "after the start",
                joint.name, stop[j], stop[j] < joint.lower ? joint.lower : joint.upper, turn);
  }
  return stop;
}

}  // namespace mneme
