// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/as_index.h"
#include "path/waypoints.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mneme::internal {
namespace {

/// Motions of one joint from rest to rest: seven segments of constant jerk, or fewer.
struct RestToRest {
  double velocity, acceleration, jerk;

  /// The time from rest to `speed`.
  [[nodiscard]] double change_s(double speed) const {
    const bool is_short = speed < acceleration * acceleration / jerk;
    return is_short ? 2 * std::sqrt(speed / jerk) : speed / acceleration + acceleration / jerk;
  }

  [[nodiscard]] double duration_s(double distance) const {
    const double a = acceleration, longest_s = change_s(velocity);
    if (distance >= velocity * longest_s) return distance / velocity + longest_s;
    if (distance < 2 * a * a * a / (jerk * jerk)) return 4 * std::cbrt(distance / (2 * jerk));
    const double ramp_speed = a * a / jerk;
    const double peak = 0.5 * (std::sqrt(ramp_speed * ramp_speed + 4 * a * distance) - ramp_speed);
    return 2 * change_s(peak);
  }

  /// The inverse of duration_s().
  [[nodiscard]] double distance(double duration_s) const {
    const double half_s = duration_s / 2, full_ramp_s = acceleration / jerk;
    const double ramp_s = std::min(full_ramp_s, half_s / 2);
    const double steepest = ramp_s < full_ramp_s ? jerk * ramp_s : acceleration;
    const double peak = steepest * (half_s - ramp_s);
    return peak <= velocity ? peak * half_s : velocity * (duration_s - change_s(velocity));
  }
};

RestToRest rest_to_rest(const RateLimits& limits, std::size_t joint) {
  return {limits.velocity[joint], limits.acceleration[joint],
          limits.jerk.empty() ? std::numeric_limits<double>::infinity() : limits.jerk[joint]};
}

std::vector<float> paces_by_velocity(const Robot& robot) {
  constexpr double kSlowest = 1e-3;  // a limit of 0 means that a joint does not move by itself
  std::vector<float> paces;
  for (int i = 0; i < robot.joint_count(); ++i) {
    paces.push_back(static_cast<float>(1 / std::max(robot.group_joint(i).velocity, kSlowest)));
  }
  return paces;
}

}  // namespace

std::vector<float> paces_of(const Robot& robot, const Path& path, const RateLimits* limits) {
  constexpr double kLeastTime = 1e-3;  // seconds, of a path that returns to its start
  if (limits == nullptr || path.empty()) return paces_by_velocity(robot);
  const auto joints = as_index(robot.joint_count());
  const Configuration end = robot.turned_near(path.back(), path.front());
  double time_s = kLeastTime;
  for (std::size_t j = 0; j < joints; ++j) {
    const double distance = std::abs(end[j] - path.front()[j]);
    time_s = std::max(time_s, rest_to_rest(*limits, j).duration_s(distance));
  }
  std::vector<float> paces;
  for (std::size_t j = 0; j < joints; ++j) {
    paces.push_back(static_cast<float>(time_s / rest_to_rest(*limits, j).distance(time_s)));
  }
  return paces;
}

}  // namespace mneme::internal
