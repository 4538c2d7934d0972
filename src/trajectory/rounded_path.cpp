// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "trajectory/rounded_path.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace mneme::internal {
namespace {

/// Waypoints closer than this, radians or metres, differ by rounding errors only.
constexpr double kSamePlace = 1e-6;
/// Shorter curves are dropped.
constexpr double kNothing = 1e-12;
/// Factor on the tolerance for the next attempt at a corner that is not free.
constexpr double kTighter = 0.25;
constexpr int kAttempts = 3;

/// Drops waypoints that repeat the last one; keeps start and end.
std::vector<const Configuration*> find_waypoints(const Robot& robot, const Path& path) {
  std::vector<const Configuration*> kept = {&path.front()};
  const auto is_here = [&](const Configuration& q) {
    return robot.distance(*kept.back(), q) <= kSamePlace;
  };
  for (const Configuration& waypoint : path) {
    if (!is_here(waypoint)) kept.push_back(&waypoint);
  }
  while (kept.size() > 1 && is_here(path.back())) kept.pop_back();
  if (!is_here(path.back())) kept.push_back(&path.back());
  return kept;
}

/// Rounds the corner between two legs.
class Corner {
 public:
  Corner(const Leg& in, const Leg& out)
      : in_(in), out_(out), turn_(plus(out.direction, -1, in.direction)) {}

  /// The widest parabola that passes, or nothing.
  [[nodiscard]] std::optional<Curve> round(double tolerance, const MotionVerifier& verifier) const {
    // Each corner may take half of a leg. Reach and deviation grow together: see parabola().
    const double room = 0.5 * std::min(in_.length, out_.length);
    const double widest = std::min(tolerance, 0.25 * room * norm(turn_));
    double deviation = widest;
    for (int i = 0; i < kAttempts; ++i, deviation *= kTighter) {
      const double reach = norm(turn_) > 0 ? 4 * deviation / norm(turn_) : room;
      if (reach <= kSamePlace) return std::nullopt;
      Curve curve = parabola(std::min(reach, room));
      if (is_free(curve, verifier)) return curve;
    }
    return std::nullopt;
  }

 private:
  /// Leaves the first leg `reach` before the corner and joins the second one `reach` after it. Its
  /// distance to the legs is at most that of its middle to the corner: |turn| reach / 4.
  [[nodiscard]] Curve parabola(double reach) const {
    return {plus(in_.begin, in_.length - reach, in_.direction), in_.direction,
            plus(std::vector<double>(turn_.size()), 0.5 / reach, turn_), 2 * reach};
  }

  [[nodiscard]] static bool is_free(const Curve& curve, const MotionVerifier& verifier) {
    const double step = curve.length / kChords;
    std::vector<float> states, bow;
    for (int i = 0; i <= kChords; ++i) {
      for (std::size_t joint = 0; joint < curve.begin.size(); ++joint) {
        states.push_back(static_cast<float>(curve.value(joint, i * step)));
      }
    }
    for (const double bend : curve.bend) {
      bow.push_back(static_cast<float>(0.125 * bend * step * step));
    }
    CheckCounters counters;
    return verifier.is_curve_free(states, bow, counters);
  }

  const Leg& in_;
  const Leg& out_;
  std::vector<double> turn_;
};

/// The part of a leg between its corners.
Curve straight(const Leg& leg, double from, double to) {
  return {plus(leg.begin, from, leg.direction), leg.direction, {}, to - from};
}

}  // namespace

std::vector<double> plus(std::vector<double> a, double factor, const std::vector<double>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] += factor * b[i];
  return a;
}

double norm(const std::vector<double>& v) {
  double sum = 0;
  for (const double value : v) sum += value * value;
  return std::sqrt(sum);
}

bool begins_outside(const Robot& robot, const Path& path) {
  return !robot.is_configuration(path.front());
}

Legs find_legs(const Robot& robot, const Path& path) {
  Legs found{{}, path.front()};
  const std::vector<const Configuration*> waypoints = find_waypoints(robot, path);
  for (std::size_t i = 1; i < waypoints.size(); ++i) {
    const Configuration delta = robot.difference(*waypoints[i - 1], *waypoints[i]);
    const double length = norm(delta);
    found.legs.push_back({found.end, plus(Configuration(delta.size()), 1 / length, delta), length});
    found.end = plus(found.end, 1, delta);
  }
  return found;
}

RoundedPath round_corners(const Robot& robot, const Path& path, double tolerance,
                          const MotionVerifier* verifier) {
  const auto [legs, end] = find_legs(robot, path);
  RoundedPath rounded{{}, end};
  const bool is_outside = begins_outside(robot, path);
  double from = 0;  // on the leg
  bool is_at_rest = true;
  const auto add = [&](Curve curve) {
    if (curve.length <= kNothing) return;
    curve.begins_at_rest = std::exchange(is_at_rest, false);
    rounded.curves.push_back(std::move(curve));
  };
  for (std::size_t i = 0; i < legs.size(); ++i) {
    std::optional<Curve> curve;
    if (i + 1 < legs.size() && verifier != nullptr && !(is_outside && i == 0)) {
      curve = Corner(legs[i], legs[i + 1]).round(tolerance, *verifier);
    }
    const double reach = curve ? 0.5 * curve->length : 0;
    add(straight(legs[i], from, legs[i].length - reach));
    is_at_rest = is_at_rest || !curve;
    if (curve) add(*std::move(curve));
    from = reach;
  }
  return rounded;
}

}  // namespace mneme::internal
