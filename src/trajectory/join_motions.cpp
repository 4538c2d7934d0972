// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// A blend leaves one motion before its end and enters the next one after its begin. Both are cut at
// several distances from where they join, and the shortest connection of the cuts that keeps the
// limits is looked for. The proof comes last, the fastest first.
#include "mneme/trajectory.h"

#include "trajectory/rounded_path.h"
#include "trajectory/smooth_motion.h"
#include "trajectory/speed_profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace mneme {
namespace internal {
namespace {

using Point = Trajectory::Point;

/// Shares of the tolerance at which motions are cut.
constexpr double kCuts[] = {0.95, 0.7, 0.5, 0.3, 0.15, 0.05, 0.02};
/// Factors on these, for the first and the second motion.
constexpr std::pair<double, double> kSides[] = {{1, 1}, {1, 0.3}, {0.3, 1}};
/// Shares of a blend in which accelerations change, if jerk is limited.
constexpr double kRamps[] = {0.05, 0.1, 0.17, 0.24, 0.31};
/// Shares of the time in between at which acceleration changes to its second value.
constexpr double kSwitches[] = {0.5, 0.35, 0.65, 0.2, 0.8, 0.07, 0.93};
constexpr int kDurations = 16;  ///< that are tried between the cuts, up to that with the stop
constexpr int kDurationBisections = 6;
constexpr double kLeastGain_s = 1e-4;
constexpr double kLimitRounding = 1e-9;  ///< of limits, as a share

/// A joint's acceleration changes for `ramp_s` from that of the begin to a first value, later for
/// `ramp_s` to a second value, and at last for `ramp_s` to that of the end.
struct JointConnection {
  double position = 0, velocity = 0;
  std::array<double, 6> times_s, accelerations;  ///< acceleration is linear between these times

  /// Both values follow from the changes of position and velocity: the integrals of accelerations,
  /// and of accelerations times the remaining time, are linear in the values. The middle of the
  /// second change is at `switch_s`.
  JointConnection(const Point& from, const Point& to, std::size_t j, double duration_s,
                  double ramp_s, double switch_s)
      : position(from.position[j]), velocity(from.velocity[j]) {
    const double t = duration_s, half = ramp_s / 2, early = switch_s - half, late = switch_s + half;
    times_s = {0, ramp_s, early, late, t - ramp_s, t};
    const double steady = early - ramp_s, rest = t - ramp_s - late;
    const double a = from.acceleration[j], b = to.acceleration[j];
    const double speed = to.velocity[j] - velocity - half * (a + b);
    const double way =
        to.position[j] - position - t * velocity - half * ((t - ramp_s / 3) * a + ramp_s / 3 * b);
    const double speed1 = steady + ramp_s, speed2 = rest + ramp_s;
    const double way1 = half * (2 * t - ramp_s - early) + steady * (t - (ramp_s + early) / 2);
    const double way2 = half * (t - early - 2 * ramp_s / 3) + rest * (t - (late + t - ramp_s) / 2) +
                        half * (2 * ramp_s / 3);
    const double determinant = speed1 * way2 - speed2 * way1;
    const double first = (speed * way2 - speed2 * way) / determinant;
    const double second = (speed1 * way - speed * way1) / determinant;
    accelerations = {a, first, first, second, second, b};
    if (ramp_s == 0) accelerations.front() = first, accelerations.back() = second;
  }

  [[nodiscard]] bool keeps(double most_velocity, double most_acceleration, double most_jerk) const {
    double v = velocity;
    if (!(std::abs(v) <= most_velocity)) return false;
    for (std::size_t i = 1; i < times_s.size(); ++i) {
      const double t = times_s[i] - times_s[i - 1], a = accelerations[i - 1], b = accelerations[i];
      if (!(std::abs(a) <= most_acceleration && std::abs(b) <= most_acceleration)) return false;
      if (!(t > 0)) continue;
      if (!(std::abs(b - a) <= most_jerk * t)) return false;
      // Velocity is extreme where acceleration changes its sign.
      if (a * b < 0 && !(std::abs(v - a * a * t / (2 * (b - a))) <= most_velocity)) return false;
      v += t * (a + b) / 2;
      if (!(std::abs(v) <= most_velocity)) return false;
    }
    return true;
  }
};

/// A motion of all joints between two states.
struct Connection {
  double duration_s = 0;
  std::vector<JointConnection> joints;

  [[nodiscard]] double most_acceleration(std::size_t j) const {
    double most = 0;
    for (const double a : joints[j].accelerations) most = std::max(most, std::abs(a));
    return most;
  }

  [[nodiscard]] Trajectory motion(const Point& to) const {
    std::vector<double> times_s;
    for (const JointConnection& joint : joints) {
      times_s.insert(times_s.end(), joint.times_s.begin(), joint.times_s.end());
    }
    std::ranges::sort(times_s);
    times_s.erase(std::unique(times_s.begin(), times_s.end()), times_s.end());
    std::vector<JerkPiece> pieces;
    std::vector<JointConnection> at = joints;
    for (std::size_t i = 1; i < times_s.size(); ++i) {
      const double t = times_s[i] - times_s[i - 1], middle_s = 0.5 * (times_s[i] + times_s[i - 1]);
      JerkPiece& piece = pieces.emplace_back();
      piece.duration_s = t;
      for (JointConnection& joint : at) {
        std::size_t k = 1;
        while (joint.times_s[k] < middle_s) ++k;
        const double begin_s = joint.times_s[k - 1], begin = joint.accelerations[k - 1];
        const double jerk = (joint.accelerations[k] - begin) / (joint.times_s[k] - begin_s);
        const double a = begin + (times_s[i - 1] - begin_s) * jerk;
        piece.position.push_back(joint.position);
        piece.velocity.push_back(joint.velocity);
        piece.acceleration.push_back(a);
        piece.jerk.push_back(jerk);
        joint.position += t * (joint.velocity + t * (a / 2 + t * jerk / 6));
        joint.velocity += t * (a + t * jerk / 2);
      }
    }
    return to_trajectory(pieces, to.position);
  }
};

/// A blend between two motions: it leaves the first one at `out_s` and enters the second at `in_s`.
struct Blend {
  double out_s = 0, in_s = 0;
  double gain_s = 0;
  Connection connection;
  Trajectory motion;  ///< of the connection
};

RateLimits lower_of(RateLimits a, const RateLimits& b) {
  const auto lower = [](std::vector<double>& mine, const std::vector<double>& other) {
    mine.resize(std::max(mine.size(), other.size()), kNoLimit);
    for (std::size_t j = 0; j < other.size(); ++j) mine[j] = std::min(mine[j], other[j]);
  };
  lower(a.velocity, b.velocity);
  lower(a.acceleration, b.acceleration);
  lower(a.jerk, b.jerk);
  return a;
}

double distance(const Configuration& a, const Configuration& b) { return norm(plus(a, -1, b)); }

/// Blends between two parts.
class Blender {
 public:
  /// The first part is left after `earliest_s` of its time.
  Blender(const MotionPart& first, double earliest_s, const MotionPart& second, double tolerance)
      : first_(first),
        second_(second),
        earliest_s_(std::max(earliest_s, 0.5 * first.motion.duration_s())),
        tolerance_(tolerance),
        middle_(second.motion.at(0).position),
        limits_(lower_of(first.limits, second.limits)) {}

  [[nodiscard]] std::optional<Blend> find() const {
    std::vector<Blend> found;
    for (const double share : kCuts) {
      for (const auto& [before, after] : kSides) {
        if (auto blend = between_cuts(before * share, after * share)) {
          found.push_back(*std::move(blend));
        }
      }
    }
    std::ranges::stable_sort(found, std::ranges::greater(), &Blend::gain_s);
    for (Blend& blend : found) {
      if (is_proven(blend)) return std::move(blend);
    }
    return std::nullopt;
  }

 private:
  /// The latest time before `to_s`, but not before `from_s`, at which the motion is `reach` away
  /// from where the parts join; times may run backwards.
  [[nodiscard]] double cut(const Trajectory& motion, double from_s, double to_s,
                           double reach) const {
    if (distance(motion.at(from_s).position, middle_) <= reach) return from_s;
    for (int i = 0; i < 24; ++i) {
      const double half_s = 0.5 * (from_s + to_s);
      (distance(motion.at(half_s).position, middle_) > reach ? from_s : to_s) = half_s;
    }
    return to_s;
  }

  [[nodiscard]] std::optional<Blend> between_cuts(double before, double after) const {
    const double end_s = first_.motion.duration_s();
    const double out_s = cut(first_.motion, earliest_s_, end_s, before * tolerance_);
    const double in_s =
        cut(second_.motion, 0.5 * second_.motion.duration_s(), 0, after * tolerance_);
    const double most_s = end_s - out_s + in_s;
    if (!(most_s > kLeastGain_s)) return std::nullopt;
    const Point from = first_.motion.at(out_s), to = second_.motion.at(in_s);
    for (int i = 1; i < kDurations; ++i) {
      double least = most_s * (i - 1) / kDurations;
      auto found = connect(from, to, most_s * i / kDurations);
      if (!found) continue;
      for (int k = 0; k < kDurationBisections; ++k) {
        const double half_s = 0.5 * (least + found->duration_s);
        if (auto faster = connect(from, to, half_s)) {
          found = std::move(faster);
        } else {
          least = half_s;
        }
      }
      const double gain_s = most_s - found->duration_s;
      if (gain_s < kLeastGain_s) return std::nullopt;
      return Blend{out_s, in_s, gain_s, *found, found->motion(to)};
    }
    return std::nullopt;
  }

  /// A connection within the limits, if there is one of this duration.
  [[nodiscard]] std::optional<Connection> connect(const Point& from, const Point& to,
                                                  double duration_s) const {
    if (!has_jerk_limit(limits_)) return connect(from, to, duration_s, 0);
    for (const double share : kRamps) {
      if (auto found = connect(from, to, duration_s, share * duration_s)) return found;
    }
    return std::nullopt;
  }

  [[nodiscard]] std::optional<Connection> connect(const Point& from, const Point& to,
                                                  double duration_s, double ramp_s) const {
    constexpr double kMost = 1 + kLimitRounding;
    Connection connection{duration_s, {}};
    for (std::size_t j = 0; j < middle_.size(); ++j) {
      const double jerk = limits_.jerk.empty() ? kNoLimit : limits_.jerk[j];
      const std::size_t count = connection.joints.size();
      for (const double share : kSwitches) {
        const double switch_s = 1.5 * ramp_s + share * (duration_s - 3 * ramp_s);
        const JointConnection joint(from, to, j, duration_s, ramp_s, switch_s);
        if (!joint.keeps(kMost * limits_.velocity[j], kMost * limits_.acceleration[j],
                         kMost * jerk)) {
          continue;
        }
        connection.joints.push_back(joint);
        break;
      }
      if (connection.joints.size() == count) return std::nullopt;
    }
    return connection;
  }

  [[nodiscard]] bool is_proven(const Blend& blend) const {
    const Robot& robot = first_.verifier->checker().robot();
    // Many turns of a continuous joint would lose digits in single precision.
    const Configuration turns = plus(middle_, -1, robot.normalized(middle_));
    const double dt = blend.connection.duration_s / kChords;
    std::vector<float> states, bow;
    for (std::size_t j = 0; j < middle_.size(); ++j) {
      bow.push_back(static_cast<float>(blend.connection.most_acceleration(j) * dt * dt / 8));
    }
    double wide = 0;
    for (const float value : bow) wide = std::hypot(wide, double{value});
    for (int i = 0; i <= kChords; ++i) {
      Configuration q = blend.motion.at(i * dt).position;
      if (!(distance(q, middle_) + wide <= tolerance_) || !is_within(robot, q, bow)) return false;
      q = plus(q, -1, turns);
      states.insert(states.end(), q.begin(), q.end());
    }
    CheckCounters counters;
    return first_.verifier->is_curve_free(states, bow, counters) &&
           second_.verifier->is_curve_free(states, bow, counters);
  }

  [[nodiscard]] static bool is_within(const Robot& robot, const Configuration& q,
                                      const std::vector<float>& bow) {
    for (std::size_t j = 0; j < q.size(); ++j) {
      const Joint& joint = robot.group_joint(static_cast<int>(j));
      if (joint.type == JointType::continuous) continue;
      const double off = double{bow[j]};
      if (!(q[j] - off >= joint.lower && q[j] + off <= joint.upper)) return false;
    }
    return true;
  }

  const MotionPart& first_;
  const MotionPart& second_;
  double earliest_s_, tolerance_;
  Configuration middle_;  ///< where the parts join
  RateLimits limits_;
};

/// Motions one after the other.
class MotionChain {
 public:
  void add(const Trajectory& motion) {
    for (Trajectory::Stretch stretch : motion.stretches()) {
      stretch.begin_s += time_s;
      stretches_.push_back(std::move(stretch));
    }
  }
  [[nodiscard]] Trajectory finish(Configuration end) && {
    return {std::move(stretches_), std::move(end), time_s};
  }

  double time_s = 0;

 private:
  std::vector<Trajectory::Stretch> stretches_;
};

}  // namespace
}  // namespace internal

JoinedMotion join_motions(std::span<const MotionPart> parts, double tolerance) {
  using internal::Blend;
  internal::MotionChain chain;
  std::vector<double> begins_s = {0};
  double in_s = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Trajectory& motion = parts[i].motion;
    const double end_s = motion.duration_s();
    const bool is_last = i + 1 == parts.size();
    const bool may_blend = !is_last && !parts[i].stops && tolerance > 0 &&
                           parts[i].verifier != nullptr && parts[i + 1].verifier != nullptr;
    std::optional<Blend> blend;
    if (may_blend) blend = internal::Blender(parts[i], in_s, parts[i + 1], tolerance).find();
    const double out_s = blend ? blend->out_s : end_s;
    chain.add(motion.between(in_s, out_s));
    chain.time_s += out_s - in_s;
    in_s = 0;
    double begin_s = chain.time_s;
    if (blend) {
      chain.add(blend->motion);
      begin_s += 0.5 * blend->connection.duration_s;
      chain.time_s += blend->connection.duration_s;
      in_s = blend->in_s;
    }
    if (!is_last) begins_s.push_back(begin_s);
  }
  const Trajectory& last = parts.back().motion;
  return {std::move(chain).finish(last.at(last.duration_s()).position), std::move(begins_s)};
}

}  // namespace mneme
