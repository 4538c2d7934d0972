// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "trajectory/rate_limits.h"

#include "base/as_index.h"
#include "base/check_ranges.h"
#include "base/text_file.h"
#include "scene/yaml.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

namespace mneme {
namespace internal {
namespace {

/// Whoever writes more into a file means that there is no limit.
constexpr double kMostRate = 1e6;
constexpr double kLeastRate = 1e-6;

/// Of any joint of the robot, also of those outside the group.
struct JointRates {
  double velocity = 0;
  std::optional<double> acceleration;
};
using Rates = std::map<std::string, JointRates>;

Rates rates_of_urdf(const Robot& robot) {
  Rates rates;
  for (const Joint& joint : robot.joints()) {
    rates[joint.name] = {joint.velocity, joint.acceleration};
  }
  return rates;
}

/// The value of `max_QUANTITY`, unless `has_QUANTITY_limits` is false or both are missing.
std::optional<double> read_limit(const Input& joint, const std::string& quantity) {
  const auto has = joint.find(fmt::format("has_{}_limits", quantity));
  const bool is_said = has.has_value();
  if (is_said && !has->boolean()) return std::nullopt;
  const std::string key = "max_" + quantity;
  const auto most = is_said ? std::optional(joint.at(key)) : joint.find(key);
  if (!most) return std::nullopt;
  return most->positive_number();
}

/// A limit that would be left aside in silence.
void refuse_limit(const Input& joint, std::string_view has, std::string_view what) {
  const auto found = joint.find(has);
  if (found && found->boolean()) {
    found->fail(ErrorCode::unsupported, fmt::format("{} are not supported here", what));
  }
}

void read_joint(const Input& joint, JointRates& rates) {
  joint.allow_keys({"has_velocity_limits", "max_velocity", "has_acceleration_limits",
                    "max_acceleration", "has_jerk_limits", "max_jerk", "has_position_limits",
                    "min_position", "max_position"});
  refuse_limit(joint, "has_jerk_limits", "limits of jerk");
  refuse_limit(joint, "has_position_limits", "limits of positions, which are the URDF's,");
  if (const auto velocity = read_limit(joint, "velocity")) rates.velocity = *velocity;
  if (const auto acceleration = read_limit(joint, "acceleration")) {
    rates.acceleration = *acceleration;
  }
}

void read_file(const std::string& file, const Robot& robot, Rates& rates) {
  const std::string text = value_or_throw(read_text_file(file));
  const InputValue value = parse_yaml(text, file);
  const Input input(value, file);
  input.allow_keys(
      {"joint_limits", "default_velocity_scaling_factor", "default_acceleration_scaling_factor"});
  for (const auto& [name, joint] : input.at("joint_limits").entries()) {
    const auto found = rates.find(name);
    if (found == rates.end()) {
      joint.fail(ErrorCode::invalid, fmt::format("robot '{}' has no such joint", robot.name()));
    }
    read_joint(joint, found->second);
  }
}

RateLimits limits_of_group(const Robot& robot, const Rates& rates, double acceleration) {
  RateLimits limits;
  for (int i = 0; i < robot.joint_count(); ++i) {
    const JointRates& own = rates.at(robot.group_joint(i).name);
    limits.velocity.push_back(std::min(own.velocity, kMostRate));
    limits.acceleration.push_back(std::min(own.acceleration.value_or(acceleration), kMostRate));
  }
  return limits;
}

/// Slows joints down for those that follow them.
void heed_followers(const Robot& robot, const Rates& rates, double acceleration,
                    RateLimits& limits) {
  for (const Joint& joint : robot.joints()) {
    if (!joint.mimic || joint.mimic->multiplier == 0) continue;
    const auto leader = std::ranges::find(robot.group(), joint.mimic->joint);
    if (leader == robot.group().end()) continue;
    const auto i = static_cast<std::size_t>(leader - robot.group().begin());
    const double ratio = std::abs(joint.mimic->multiplier);
    const JointRates& own = rates.at(joint.name);
    limits.velocity[i] = std::min(limits.velocity[i], own.velocity / ratio);
    limits.acceleration[i] =
        std::min(limits.acceleration[i], own.acceleration.value_or(acceleration) / ratio);
  }
}

Result<void> check_rates(const Robot& robot, const std::vector<double>& rates,
                         std::string_view what) {
  if (as_index(robot.joint_count()) != rates.size()) {
    return fail(ErrorCode::invalid,
                fmt::format("there are {} limits of {}, but robot '{}' has {} "
                            "joints in its group",
                            rates.size(), what, robot.name(), robot.joint_count()));
  }
  for (int i = 0; i < robot.joint_count(); ++i) {
    const double rate = rates[as_index(i)];
    // Written so that a NaN is refused.
    if (rate >= kLeastRate && rate <= kMostRate) continue;
    return fail(ErrorCode::invalid,
                fmt::format("joint '{}': its limit of {} is {}, expected {} to {}",
                            robot.group_joint(i).name, what, rate, kLeastRate, kMostRate));
  }
  return {};
}

}  // namespace

Result<void> check_rate_limits(const Robot& robot, const RateLimits& limits) {
  if (auto checked = check_rates(robot, limits.velocity, "velocity"); !checked) return checked;
  return check_rates(robot, limits.acceleration, "acceleration");
}

}  // namespace internal

Result<RateLimits> find_rate_limits(const Robot& robot, const TrajectorySettings& settings,
                                    const std::string& file) {
  if (auto checked = internal::check_ranges(settings); !checked) {
    return tl::unexpected(checked.error());
  }
  internal::Rates rates = internal::rates_of_urdf(robot);
  if (!file.empty()) {
    const auto read = internal::without_throwing([&] {
      internal::read_file(file, robot, rates);
      return true;
    });
    if (!read) return tl::unexpected(read.error());
  }
  RateLimits limits = internal::limits_of_group(robot, rates, settings.acceleration_limit);
  internal::heed_followers(robot, rates, settings.acceleration_limit, limits);
  for (double& velocity : limits.velocity) velocity *= settings.velocity_scale;
  for (double& rate : limits.acceleration) rate *= settings.acceleration_scale;
  if (auto checked = internal::check_rate_limits(robot, limits); !checked) {
    return tl::unexpected(checked.error());
  }
  return limits;
}

}  // namespace mneme
