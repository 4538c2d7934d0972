// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/trajectory.h"

#include <algorithm>
#include <cmath>

namespace mneme {
namespace {

constexpr int kParts = 8;  ///< of a stretch, an even number for Simpson's rule

/// The derivatives of first to third order of a joint of a stretch.
struct Rates {
  double velocity = 0, acceleration = 0, jerk = 0;
};

Rates rates_at(const std::vector<double>& coefficients, std::size_t joint, std::size_t joints,
               double t) {
  Rates rates;
  double value = 0;
  for (std::size_t k = coefficients.size() / joints; k-- > 0;) {
    rates.jerk = rates.jerk * t + 3 * rates.acceleration;
    rates.acceleration = rates.acceleration * t + 2 * rates.velocity;
    rates.velocity = rates.velocity * t + value;
    value = value * t + coefficients[k * joints + joint];
  }
  return rates;
}

void raise(double& most, double value) { most = std::max(most, std::abs(value)); }

/// The shares of `limits`, which may be infinite, or empty for none.
std::vector<double> shares(const std::vector<double>& values, const std::vector<double>& limits) {
  std::vector<double> shares(values.size());
  for (std::size_t j = 0; j < limits.size(); ++j) shares[j] = values[j] / limits[j];
  return shares;
}

}  // namespace

MotionMeasures measure_motion(const Trajectory& motion, const RateLimits& limits) {
  const std::size_t joints = motion.at(0).position.size();
  const std::vector<double> none(joints);
  MotionMeasures measures{motion.duration_s(), 0, none, none, none, {}, {}, {}};
  const std::vector<Trajectory::Stretch>& stretches = motion.stretches();
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    const bool is_last = i + 1 == stretches.size();
    const double end_s = is_last ? motion.duration_s() : stretches[i + 1].begin_s;
    const double step_s = (end_s - stretches[i].begin_s) / kParts;
    for (std::size_t j = 0; j < joints; ++j) {
      for (int k = 0; k <= kParts; ++k) {
        const Rates rates = rates_at(stretches[i].coefficients, j, joints, k * step_s);
        raise(measures.velocity[j], rates.velocity);
        raise(measures.acceleration[j], rates.acceleration);
        raise(measures.jerk[j], rates.jerk);
        // Simpson's weights 1, 4, 2, 4, .., 1: jerk is linear in time, its square quadratic.
        const int weight = k == 0 || k == kParts ? 1 : k % 2 == 1 ? 4 : 2;
        measures.jerk_integral += weight * step_s / 3 * rates.jerk * rates.jerk;
      }
    }
  }
  measures.velocity_use = shares(measures.velocity, limits.velocity);
  measures.acceleration_use = shares(measures.acceleration, limits.acceleration);
  measures.jerk_use = shares(measures.jerk, limits.jerk);
  return measures;
}

}  // namespace mneme
