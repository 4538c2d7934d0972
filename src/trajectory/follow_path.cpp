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
#include <string_view>
#include <utility>

namespace mneme {
namespace internal {
namespace {

/// Stops are longer by this share, so that rounding does not make a leg too short for its stop.
constexpr double kStopRoom = 1e-7;
/// Continuous joints turn by less than pi by this, as verification wants it.
constexpr double kTurnRoom = 1e-3;
/// Largest part of an end's velocity across its leg, as a share of the speed, and rounding of the
/// leg's ends.
constexpr double kMostAcross = 1e-6, kRoundingOfEnds = 1e-14;
/// Clearance of corners, metres, from which rounds begin if they find nothing from free ones.
/// Rounds want less of states, and their first spline is not quite on the corner.
constexpr double kCornerMargin = 1e-3;

/// Words for an end of a path at which the robot moves, for errors.
struct End {
  bool is_start = true;
  std::string_view name, motion, leg;
};
constexpr End kStart{true, "start velocity", "stop", "first"};
constexpr End kGoal{false, "end velocity", "run-up", "last"};

Result<void> check_velocity(const Robot& robot, const std::vector<double>& velocity,
                            const RateLimits& limits, const End& end) {
  constexpr double kSlack = 1e-9;  // of rounding
  if (velocity.size() != as_index(robot.joint_count())) {
    return fail(ErrorCode::invalid,
                "{}: got {} values, expected {}: one for each joint in the group of robot '{}'",
                end.name, velocity.size(), robot.joint_count(), robot.name());
  }
  for (std::size_t j = 0; j < velocity.size(); ++j) {
    // Written so that a NaN is refused.
    if (std::abs(velocity[j]) <= limits.velocity[j] * (1 + kSlack)) continue;
    return fail(ErrorCode::invalid, "{}: joint '{}' moves at {:.4g}, faster than its limit {:.4g}",
                end.name, robot.group_joint(static_cast<int>(j)).name, velocity[j],
                limits.velocity[j]);
  }
  return {};
}

std::vector<double> unit(const std::vector<double>& v) {
  return plus(std::vector<double>(v.size()), 1 / norm(v), v);
}

/// Where a stop from `velocity` at `q` ends, or a run-up to it begins; see stopping_point().
Result<Configuration> far_end(const Robot& robot, const Configuration& q,
                              const std::vector<double>& velocity, const RateLimits& limits,
                              const End& end) {
  if (q.size() != as_index(robot.joint_count())) {
    return fail(ErrorCode::invalid, "{}: expected {} joint values for robot {}, got {}", end.name,
                robot.joint_count(), robot.name(), q.size());
  }
  MNEME_TRY(check_rate_limits(robot, limits));
  MNEME_TRY(check_velocity(robot, velocity, limits, end));
  const double speed = norm(velocity);
  if (speed == 0) return q;
  const std::vector<double> direction = unit(velocity);
  const double length = reach_to_stop(direction, speed, limits);
  if (length < kLeastStop) return q;
  Configuration rest = plus(q, (end.is_start ? 1 : -1) * (1 + kStopRoom) * length, direction);
  for (std::size_t j = 0; j < rest.size(); ++j) {
    const Joint& joint = robot.group_joint(static_cast<int>(j));
    const double turn = std::abs(rest[j] - q[j]);
    if (joint.type == JointType::continuous) {
      if (turn < std::numbers::pi - kTurnRoom) continue;
      return fail(ErrorCode::invalid,
                  "{}: the {} of joint '{}' would turn it by {:.4g}, expected less than pi: lower "
                  "the velocity or raise the limits",
                  end.name, end.motion, joint.name, turn);
    }
    if (rest[j] >= joint.lower && rest[j] <= joint.upper) continue;
    return fail(ErrorCode::invalid,
                "{}: joint '{}' would {} at {:.4g}, beyond its limit {:.4g}: {:.4g} {}", end.name,
                joint.name, end.is_start ? "stop" : "have to start", rest[j],
                rest[j] < joint.lower ? joint.lower : joint.upper, turn,
                end.is_start ? "after the start" : "before the end");
  }
  return rest;
}

/// The speed at an end of the path; 0 if it counts as rest.
Result<double> speed_at(const Timing& timing, const Legs& legs, const std::vector<double>& velocity,
                        const End& end) {
  if (velocity.empty()) return 0.0;
  MNEME_TRY(check_velocity(timing.robot, velocity, timing.limits, end));
  const double speed = norm(velocity);
  if (speed == 0 || reach_to_stop(unit(velocity), speed, timing.limits) < kLeastStop) return 0.0;
  if (legs.legs.empty()) {
    return fail(ErrorCode::invalid, "{}: the path does not move, expected a {} on it", end.name,
                end.motion);
  }
  const Leg& leg = end.is_start ? legs.legs.front() : legs.legs.back();
  const double across = std::max(kMostAcross, kRoundingOfEnds / leg.length);
  if (norm(plus(velocity, -speed, leg.direction)) > across * speed) {
    return fail(ErrorCode::invalid,
                "{}: expected it along the path's {} motion; solve() plans such paths from "
                "problems with this velocity",
                end.name, end.leg);
  }
  const double reach = reach_to_stop(leg.direction, speed, timing.limits);
  if (reach > leg.length) {
    return fail(ErrorCode::invalid,
                "{}: a {} takes {:.4g} (L2 joint distance), and the path's {} motion is {:.4g} "
                "long",
                end.name, end.motion, reach, end.leg, leg.length);
  }
  return speed;
}

/// `second` after `first`, which ends at rest where `second` begins.
Trajectory join(const Trajectory& first, const Trajectory& second) {
  std::vector<Trajectory::Stretch> stretches = first.stretches();
  for (Trajectory::Stretch stretch : second.stretches()) {
    stretch.begin_s += first.duration_s();
    stretches.push_back(std::move(stretch));
  }
  Trajectory::Point end = second.at(second.duration_s());
  return {std::move(stretches), std::move(end.position), first.duration_s() + second.duration_s(),
          std::move(end.velocity)};
}

/// The motion along legs from `begin_speed` to `end_speed`.
Trajectory follow(const Timing& timing, const Legs& legs, const FollowSettings& settings,
                  const MotionVerifier* verifier) {
  return to_trajectory(
      follow_legs(legs, timing.limits, settings, verifier), legs.end,
      plus(std::vector<double>(legs.end.size()), settings.end_speed, legs.legs.back().direction));
}

Trajectory follow_from_rest(const Timing& timing, const Path& path) {
  const Robot& robot = timing.robot;
  const RateLimits& limits = timing.limits;
  const TrajectorySettings& settings = timing.settings;
  const MotionVerifier* verifier = timing.verifier;
  const Legs legs = find_legs(robot, path);
  const FollowSettings following{settings.path_tolerance, begins_outside(robot, path)};
  const bool has_rounds = verifier != nullptr && !following.stops_first && settings.time_rounds > 0;
  const bool has_jerk = has_jerk_limit(limits);
  const auto pass_corners = [&](const FollowSettings& how) {
    return to_trajectory(follow_legs(legs, limits, how, verifier), legs.end);
  };
  const auto follow_parabolas = [&] {
    return follow_fastest(round_corners(robot, path, settings.path_tolerance, verifier), limits);
  };
  if (!has_rounds) return has_jerk ? pass_corners(following) : follow_parabolas();
  const auto shorten = [&](const Trajectory& guide) {
    return shorten_time(robot, guide, legs, limits, settings, *verifier);
  };
  // Rounds mostly leave the corners, so that these are proven only if they may remain.
  FollowSettings guiding = following, estimating = following;
  guiding.is_guide = estimating.is_estimate = true;
  const Trajectory guide = pass_corners(guiding);
  auto best = shorten(guide);
  if (!best) {
    // The corners may be so near to obstacles that no round passes.
    guiding.guide_margin = kCornerMargin;
    const Trajectory wider = pass_corners(guiding);
    if (wider.duration_s() > guide.duration_s()) best = shorten(wider);
  }
  if (best && best->duration_s() <= duration_along(legs, limits, estimating, nullptr)) {
    return *std::move(best);
  }
  const auto offer = [&](Trajectory motion) {
    if (!best || motion.duration_s() < best->duration_s()) best = std::move(motion);
  };
  offer(pass_corners(following));
  if (!has_jerk) offer(follow_parabolas());
  return *std::move(best);
}

/// Stops on the first leg and starts for the end on the last one, as far as there is a speed.
Trajectory rest_in_between(const Timing& timing, const Path& path, const Legs& legs,
                           double begin_speed, double end_speed) {
  const Leg &first = legs.legs.front(), &last = legs.legs.back();
  const auto reach = [&](const Leg& leg, double speed) {
    const double length = (1 + kStopRoom) * reach_to_stop(leg.direction, speed, timing.limits);
    return std::min(leg.length, length);
  };
  const double stop = reach(first, begin_speed), run_up = reach(last, end_speed);
  Path middle = path;
  if (begin_speed > 0) middle.front() = plus(first.begin, stop, first.direction);
  if (end_speed > 0) middle.back() = plus(legs.end, -run_up, last.direction);
  Trajectory motion = follow_from_rest(timing, middle);
  if (begin_speed > 0) {
    const Legs stopping{{{first.begin, first.direction, stop}}, middle.front()};
    motion = join(follow(timing, stopping, {0, true, begin_speed}, nullptr), motion);
  }
  if (end_speed > 0) {
    const Legs starting{{{middle.back(), last.direction, run_up}}, legs.end};
    motion = join(motion, follow(timing, starting, {0, true, 0, end_speed}, nullptr));
  }
  return motion;
}

}  // namespace

Result<Trajectory> follow_path(const Timing& timing, const Path& path,
                               const EndVelocities& velocities) {
  const Legs legs = find_legs(timing.robot, path);
  const double begin_speed = MNEME_TRY(speed_at(timing, legs, velocities.start, kStart));
  const double end_speed = MNEME_TRY(speed_at(timing, legs, velocities.end, kGoal));
  if (begin_speed == 0 && end_speed == 0) return follow_from_rest(timing, path);
  const double needed = reach_to_stop(legs.legs.front().direction, begin_speed, timing.limits) +
                        reach_to_stop(legs.legs.back().direction, end_speed, timing.limits);
  if (legs.legs.size() == 1 && needed > legs.legs.front().length) {
    return fail(ErrorCode::invalid,
                "start and end velocity: a stop and a run-up take {:.4g} (L2 joint distance), and "
                "the path is {:.4g} long",
                needed, legs.legs.front().length);
  }
  const FollowSettings passing{timing.settings.path_tolerance, begins_outside(timing.robot, path),
                               begin_speed, end_speed};
  Trajectory direct = follow(timing, legs, passing, timing.verifier);
  Trajectory rested = rest_in_between(timing, path, legs, begin_speed, end_speed);
  return direct.duration_s() < rested.duration_s() ? direct : rested;
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
  return internal::far_end(robot, start, velocity, limits, internal::kStart);
}

Result<Configuration> run_up_point(const Robot& robot, const Configuration& goal,
                                   const std::vector<double>& velocity, const RateLimits& limits) {
  return internal::far_end(robot, goal, velocity, limits, internal::kGoal);
}

}  // namespace mneme
