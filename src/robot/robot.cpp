// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/robot.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

namespace mneme {
namespace {

constexpr double kBoundTolerance = 1e-5;

/// `angle` in [-pi, pi), without rounding.
double wrapped(double angle) {
  const double result = std::remainder(angle, 2 * std::numbers::pi);
  return result >= std::numbers::pi ? -std::numbers::pi : result;
}

bool is_within_limits(const Joint& joint, double value) {
  return joint.type == JointType::continuous ||
         (value >= joint.lower - kBoundTolerance && value <= joint.upper + kBoundTolerance);
}

}  // namespace

std::optional<std::string> Robot::describe_violation(std::span<const double> q,
                                                     std::string_view what) const {
  if (q.size() != group().size()) {
    return fmt::format("{}: there are {} values, but robot '{}' has {} joints in its group", what,
                       q.size(), name(), joint_count());
  }
  for (int i = 0; i < joint_count(); ++i) {
    const Joint& joint = group_joint(i);
    const double value = q[static_cast<std::size_t>(i)];
    if (!std::isfinite(value)) {
      return fmt::format("{}: joint '{}' (value {} of {}) is {}, expected a finite number", what,
                         joint.name, i + 1, joint_count(), value);
    }
    if (!is_within_limits(joint, value)) {
      return fmt::format("{}: joint '{}' (value {} of {}) is {}, outside its limits [{}, {}]", what,
                         joint.name, i + 1, joint_count(), value, joint.lower, joint.upper);
    }
  }
  return std::nullopt;
}

Configuration Robot::normalized(std::span<const double> q) const {
  assert(q.size() == group().size());
  Configuration result(q.begin(), q.end());
  for (int i = 0; i < joint_count(); ++i) {
    const Joint& joint = group_joint(i);
    double& value = result[static_cast<std::size_t>(i)];
    value = joint.type == JointType::continuous ? wrapped(value)
                                                : std::clamp(value, joint.lower, joint.upper);
  }
  return result;
}

Configuration Robot::difference(std::span<const double> a, std::span<const double> b) const {
  assert(a.size() == group().size() && b.size() == group().size());
  Configuration result(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    result[i] = b[i] - a[i];
    if (group_joint(static_cast<int>(i)).type == JointType::continuous) {
      result[i] = std::remainder(result[i], 2 * std::numbers::pi);
    }
  }
  return result;
}

double Robot::distance(std::span<const double> a, std::span<const double> b) const {
  assert(a.size() == group().size() && b.size() == group().size());
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    double step = b[i] - a[i];
    if (group_joint(static_cast<int>(i)).type == JointType::continuous) {
      step = std::remainder(step, 2 * std::numbers::pi);
    }
    sum += step * step;
  }
  return std::sqrt(sum);
}

}  // namespace mneme
