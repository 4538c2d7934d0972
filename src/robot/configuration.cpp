// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/robot.h"

#include "base/as_index.h"
#include "base/fail.h"
#include "robot/kinematics.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace mneme {
namespace {

using internal::kLimitTolerance;

/// Radians of a continuous joint beyond which sines of the kernels are inaccurate.
constexpr double kFarthestTurn = 1e4;

/// `angle` in [-pi, pi), exactly.
double wrapped(double angle) {
  const double result = std::remainder(angle, 2 * std::numbers::pi);
  return result >= std::numbers::pi ? -std::numbers::pi : result;
}

/// The shortest displacement of the joint from `from` to `to`.
double step(const Joint& joint, double from, double to) {
  return joint.type == JointType::continuous ? std::remainder(to - from, 2 * std::numbers::pi)
                                             : to - from;
}

bool is_within_limits(const Joint& joint, double value) {
  return joint.type == JointType::continuous ||
         (value >= joint.lower - kLimitTolerance && value <= joint.upper + kLimitTolerance);
}

}  // namespace

Configuration internal::random_configuration(const Robot& robot, Rng& rng) {
  Configuration q;
  for (const int i : robot.group()) {
    q.push_back(rng.uniform(robot.joints()[as_index(i)].lower, robot.joints()[as_index(i)].upper));
  }
  return q;
}

Configuration internal::interpolate(const Robot& robot, std::span<const double> from,
                                    std::span<const double> to, double fraction) {
  Configuration q = robot.difference(from, to);
  for (std::size_t i = 0; i < q.size(); ++i) q[i] = from[i] + fraction * q[i];
  return q;
}

Result<Configuration> Robot::configuration_of(const GivenConfiguration& given) const {
  if (const auto* q = std::get_if<Configuration>(&given)) return *q;
  const std::string& wanted = std::get<std::string>(given);
  std::vector<std::string> known;
  std::string fault;
  for (const NamedState& state : named_states()) {
    known.push_back(state.name);
    // The same name may stand for states of several groups.
    if (state.name != wanted) continue;
    Configuration q;
    for (int i = 0; i < joint_count(); ++i) {
      const std::string& joint = group_joint(i).name;
      const auto value = state.values.find(joint);
      if (value == state.values.end()) {
        fault =
            fmt::format("state \"{}\" of group {} has no value for joint {} of the planning group",
                        wanted, state.group, joint);
        break;
      }
      q.push_back(value->second);
    }
    if (std::ssize(q) == joint_count()) return q;
  }
  if (!fault.empty()) return fail(ErrorCode::invalid, fault);
  return fail(ErrorCode::invalid,
              "expected a state that the SRDF of robot {} names ({}), got \"{}\"", name(),
              known.empty() ? "it names none" : fmt::format("{}", fmt::join(known, ", ")), wanted);
}

std::optional<std::string> Robot::describe_violation(std::span<const double> q,
                                                     std::string_view what) const {
  if (q.size() != group().size()) {
    return fmt::format("{}: there {}, but robot '{}' has {} in its group", what,
                       q.size() == 1 ? "is 1 value" : fmt::format("are {} values", q.size()),
                       name(),
                       joint_count() == 1 ? "1 joint" : fmt::format("{} joints", joint_count()));
  }
  for (int i = 0; i < joint_count(); ++i) {
    const Joint& joint = group_joint(i);
    const double value = q[internal::as_index(i)];
    if (!std::isfinite(value)) {
      return fmt::format("{}: joint '{}' (value {} of {}) is {}, expected a finite number", what,
                         joint.name, i + 1, joint_count(), value);
    }
    if (joint.type == JointType::continuous && std::abs(value) > kFarthestTurn) {
      return fmt::format("{}: joint '{}' (value {} of {}) is {}, expected at most {} rad", what,
                         joint.name, i + 1, joint_count(), value, kFarthestTurn);
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
    double& value = result[internal::as_index(i)];
    value = joint.type == JointType::continuous ? wrapped(value)
                                                : std::clamp(value, joint.lower, joint.upper);
  }
  return result;
}

Configuration Robot::turned_near(std::span<const double> q, std::span<const double> near) const {
  constexpr double kTurn = 2 * std::numbers::pi;
  Configuration result(q.begin(), q.end());
  for (std::size_t i = 0; i < result.size(); ++i) {
    if (group_joint(static_cast<int>(i)).type != JointType::continuous) continue;
    const double turns = std::round((near[i] - result[i]) / kTurn);
    if (turns != 0) result[i] += turns * kTurn;
  }
  return result;
}

Configuration Robot::difference(std::span<const double> a, std::span<const double> b) const {
  assert(a.size() == group().size() && b.size() == group().size());
  Configuration result(a.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    result[i] = step(group_joint(static_cast<int>(i)), a[i], b[i]);
  return result;
}

double Robot::distance(std::span<const double> a, std::span<const double> b) const {
  assert(a.size() == group().size() && b.size() == group().size());
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double delta = step(group_joint(static_cast<int>(i)), a[i], b[i]);
    sum += delta * delta;
  }
  return std::sqrt(sum);
}

}  // namespace mneme
