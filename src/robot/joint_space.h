// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The configuration space in single precision, for inner loops of samplers and planners.
#pragma once

#include "mneme/robot.h"

#include <cmath>
#include <limits>
#include <span>
#include <vector>

namespace mneme::internal {

/// Limits and wrapping of the planning group's joints. Const and parallel-safe.
class JointSpace {
 public:
  explicit JointSpace(const Robot& robot) {
    for (int i = 0; i < robot.joint_count(); ++i) {
      const Joint& joint = robot.group_joint(i);
      lower_.push_back(round_within(joint.lower, std::numeric_limits<float>::infinity()));
      upper_.push_back(round_within(joint.upper, -std::numeric_limits<float>::infinity()));
      // No float lies between two very close limits.
      if (lower_.back() > upper_.back()) lower_.back() = upper_.back();
      periods_.push_back(joint.type == JointType::continuous ? kTurn : 0.0f);
    }
  }

  [[nodiscard]] int joint_count() const { return static_cast<int>(lower_.size()); }
  [[nodiscard]] float lower(int joint) const { return lower_[static_cast<std::size_t>(joint)]; }
  [[nodiscard]] float upper(int joint) const { return upper_[static_cast<std::size_t>(joint)]; }
  /// Per joint: 2 pi if it is continuous, otherwise 0.
  [[nodiscard]] std::span<const float> periods() const { return periods_; }

  /// Returns `value` wrapped for a continuous joint, clamped to the limits otherwise.
  [[nodiscard]] float into_limits(int joint, float value) const {
    const auto i = static_cast<std::size_t>(joint);
    if (periods_[i] > 0) return wrapped(value);
    return value < lower_[i] ? lower_[i] : value > upper_[i] ? upper_[i] : value;
  }

  /// Writes the shortest displacement from `a` to `b`; returns its L2 norm.
  float difference(const float* a, const float* b, float* delta) const {
    float sum = 0;
    for (std::size_t i = 0; i < lower_.size(); ++i) {
      delta[i] = b[i] - a[i];
      if (periods_[i] > 0) delta[i] = wrapped(delta[i]);
      sum += delta[i] * delta[i];
    }
    return std::sqrt(sum);
  }

 private:
  static constexpr float kTurn = 6.28318530718f;

  /// Rounds a limit towards `inside`: configurations keep to their limits in double precision, too.
  static float round_within(double limit, float inside) {
    const auto rounded = static_cast<float>(limit);
    const bool is_beyond = inside > 0 ? rounded < limit : rounded > limit;
    return is_beyond ? std::nextafter(rounded, inside) : rounded;
  }

  /// The first line is a fast path: rounding is a function call for the baseline instruction set.
  static float wrapped(float value) {
    if (std::abs(value) <= kTurn / 2) return value;
    return value - kTurn * std::nearbyint(value / kTurn);
  }

  std::vector<float> lower_, upper_, periods_;
};

/// Returns standard deviations per joint: `sigma` radians, 0.5 `sigma` metres if prismatic.
[[nodiscard]] inline std::vector<float> joint_deviations(const Robot& robot, double sigma) {
  constexpr double kMetresPerRadian = 0.5;
  std::vector<float> sigmas;
  for (int i = 0; i < robot.joint_count(); ++i) {
    const bool is_prismatic = robot.group_joint(i).type == JointType::prismatic;
    sigmas.push_back(static_cast<float>(is_prismatic ? kMetresPerRadian * sigma : sigma));
  }
  return sigmas;
}

}  // namespace mneme::internal
