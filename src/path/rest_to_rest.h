// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The fastest motions of one joint from rest to rest.
#pragma once

#include "mneme/path.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace mneme::internal {

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

[[nodiscard]] inline RestToRest rest_to_rest(const RateLimits& limits, std::size_t joint) {
  return {limits.velocity[joint], limits.acceleration[joint],
          limits.jerk.empty() ? std::numeric_limits<double>::infinity() : limits.jerk[joint]};
}

}  // namespace mneme::internal
