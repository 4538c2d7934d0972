// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/as_index.h"
#include "base/check_ranges.h"
#include "base/fail.h"
#include "base/files.h"
#include "input/input.h"
#include "robot/kinematics.h"
#include "trajectory/speed_profile.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string_view>

namespace mneme {
namespace internal {
namespace {

/// Larger values in a file mean that there is no limit.
constexpr double kMostRate = 1e6;
constexpr double kLeastRate = 1e-6;
constexpr double kUnlimited = std::numeric_limits<double>::infinity();

/// Limits of any joint of the robot, also outside the group.
struct JointRates {
  double velocity = 0;
  std::optional<double> acceleration;
  std::optional<double> jerk;
};
using Rates = std::map<std::string, JointRates>;

Rates rates_of_urdf(const Robot& robot) {
  Rates rates;
  for (const Joint& joint : robot.joints()) {
    rates[joint.name] = {joint.velocity, joint.acceleration, joint.jerk};
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
  if (most->is_number() && std::isinf(most->number()) && most->number() > 0) return kUnlimited;
  const bool is_below_zero = quantity == "deceleration" && most->finite_number() < 0;
  const double limit = is_below_zero ? -most->finite_number() : most->positive_number();
  if (limit < kLeastRate) most->fail_expecting("a limit of at least {}", kLeastRate);
  return limit;
}

/// The map with the key joint_limits: the root, or below keys of ROS parameters.
Input find_limits(Input input) {
  while (input.is_map() && !input.find("joint_limits") && input.entries().size() == 1) {
    const auto [key, inner] = input.entries().front();
    if (!inner.is_map()) break;
    input = inner;
  }
  return input;
}

/// Calls `visit(joint, own)` for each joint of a map that find_limits() returned. `own` is the
/// robot's joint, or null.
template <class Visit>
void visit_joints(const Input& limits, const Robot& robot, const Visit& visit) {
  const Input joints = limits.at("joint_limits");
  if (joints.is_nothing()) return;
  for (const auto& [name, joint] : joints.entries()) {
    if (joint.is_nothing()) continue;
    const auto found = std::ranges::find(robot.joints(), name, &Joint::name);
    const Joint* const own = found == robot.joints().end() ? nullptr : &*found;
    visit(joint.taking_angles(own != nullptr && is_turning(*own)), own);
  }
}

/// Positions that a joint may have.
struct Positions {
  double least = -kUnlimited, most = kUnlimited;
};

/// As MoveIt, takes bounds as limits even where has_position_limits is missing.
Positions read_positions(const Input& joint) {
  Positions positions;
  const auto has = joint.find("has_position_limits");
  if (has && !has->boolean()) return positions;
  if (const auto least = joint.find("min_position")) positions.least = least->number();
  if (const auto most = joint.find("max_position")) positions.most = most->number();
  if (positions.least <= positions.most) return positions;
  joint.fail(ErrorCode::invalid, "expected a max_position of at least min_position, {}, got {}",
             positions.least, positions.most);
}

/// The joint that `joint` follows, or itself.
const Joint& leader_of(const Robot& robot, const Joint& joint) {
  return joint.mimic ? robot.joints()[as_index(joint.mimic->joint)] : joint;
}

/// The positions of the leader of `joint` at which that has `positions`.
Positions of_leader(const Joint& joint, const Positions& positions) {
  if (!joint.mimic) return positions;
  const auto [multiplier, offset] = std::pair(joint.mimic->multiplier, joint.mimic->offset);
  if (multiplier == 0) return {};
  const double one = (positions.least - offset) / multiplier;
  const double other = (positions.most - offset) / multiplier;
  return {std::min(one, other), std::max(one, other)};
}

/// True if the joint keeps these positions, as its leader's limits are now.
bool contain(const Positions& positions, const Robot& robot, const Joint& joint) {
  const Joint& leader = leader_of(robot, joint);
  const bool is_endless = leader.type == JointType::continuous;
  const auto [least, most] = of_leader(joint, positions);
  return least <= (is_endless ? -kUnlimited : leader.lower + kLimitTolerance) &&
         most >= (is_endless ? kUnlimited : leader.upper - kLimitTolerance);
}

/// Reads one file of limits, and collects what it ignores.
class LimitsFile {
 public:
  LimitsFile(const Robot& robot, bool strict) : robot_(robot), strict_(strict) {}

  void read(const std::string& file, Rates& rates);
  /// One warning that counts and names what was ignored; none if nothing was.
  [[nodiscard]] std::vector<std::string> warnings(const std::string& file) const;

 private:
  void read_joint(const Input& joint, const Joint& own, JointRates& rates);
  void ignore_positions(const Input& joint, const Joint& own);
  void ignore_torque(const Input& joint);
  void ignore_other_keys(const Input& map, const std::vector<std::string_view>& known);
  void ignore(const Input& input, const std::string& name, ErrorCode code,
              const std::string& fault);

  const Robot& robot_;
  bool strict_;
  std::vector<std::string> ignored_;
};

void LimitsFile::ignore(const Input& input, const std::string& name, ErrorCode code,
                        const std::string& fault) {
  if (strict_) input.fail(code, fault);
  ignored_.push_back(name);
}

void LimitsFile::ignore_other_keys(const Input& map, const std::vector<std::string_view>& known) {
  if (strict_) map.allow_keys(known);
  for (const auto& [key, input] : map.entries()) {
    if (std::ranges::find(known, key) == known.end()) ignored_.push_back(input.key());
  }
}

/// Motions that are too strong for the motors must not look as if they were checked.
void LimitsFile::ignore_torque(const Input& joint) {
  for (const char* quantity : {"effort", "torque"}) {
    const auto torque = joint.find(fmt::format("max_{}", quantity));
    const auto has = joint.find(fmt::format("has_{}_limits", quantity));
    const bool is_limited = has ? has->boolean() : torque.has_value();
    if (!is_limited) continue;
    const Input& limit = torque ? *torque : *has;
    ignore(limit, limit.key() + " (limits of torque are not kept)", ErrorCode::unsupported,
           fmt::format("limits of torque and force are not supported: lower max_acceleration to "
                       "what the motors can do, and set has_{}_limits to false",
                       quantity));
  }
}

/// Limits of positions are the robot's, which narrow_positions() has narrowed where it can.
void LimitsFile::ignore_positions(const Input& joint, const Joint& own) {
  if (contain(read_positions(joint), robot_, own)) return;
  ignore(joint, joint.key() + " (the robot's limits of position are wider)", ErrorCode::unsupported,
         "the robot's limits of position are wider: narrow the <limit> of the joint");
}

void LimitsFile::read_joint(const Input& joint, const Joint& own, JointRates& rates) {
  ignore_torque(joint);
  ignore_other_keys(
      joint, {"has_velocity_limits", "max_velocity", "has_acceleration_limits", "max_acceleration",
              "has_deceleration_limits", "max_deceleration", "has_jerk_limits", "max_jerk",
              "has_effort_limits", "max_effort", "has_torque_limits", "max_torque",
              "has_position_limits", "min_position", "max_position"});
  ignore_positions(joint, own);
  if (const auto velocity = read_limit(joint, "velocity")) rates.velocity = *velocity;
  const auto acceleration = read_limit(joint, "acceleration");
  const auto deceleration = read_limit(joint, "deceleration");
  // One bound serves for both; pilz writes decelerations below 0.
  if (acceleration || deceleration) {
    rates.acceleration =
        std::min(acceleration.value_or(kUnlimited), deceleration.value_or(kUnlimited));
  }
  if (const auto jerk = read_limit(joint, "jerk")) rates.jerk = *jerk;
}

void LimitsFile::read(const std::string& file, Rates& rates) {
  const std::string text = value_or_throw(read_text_file(file));
  const InputValue value = parse_yaml(text, file);
  const Input input = find_limits(Input(value, file));
  static_cast<void>(input.at("joint_limits"));
  ignore_other_keys(input, {"joint_limits"});
  visit_joints(input, robot_, [&](const Input& joint, const Joint* own) {
    if (own != nullptr) return read_joint(joint, *own, rates.at(own->name));
    ignore(joint, joint.key() + " (no such joint)", ErrorCode::invalid,
           fmt::format("robot '{}' has no such joint", robot_.name()));
  });
}

std::vector<std::string> LimitsFile::warnings(const std::string& file) const {
  constexpr std::size_t kMostNamed = 12;
  if (ignored_.empty()) return {};
  const std::size_t shown = std::min(ignored_.size(), kMostNamed);
  return {
      fmt::format("{}: ignored {} (an error if strict): {}{}", file,
                  ignored_.size() == 1 ? "1 key" : fmt::format("{} keys", ignored_.size()),
                  fmt::join(ignored_.begin(), ignored_.begin() + static_cast<long>(shown), ", "),
                  shown < ignored_.size() ? ", ..." : "")};
}

/// Adds the limits of the settings where the joint has none.
JointRates complete(JointRates own, const TrajectorySettings& settings) {
  if (!own.acceleration) own.acceleration = settings.acceleration_limit;
  if (!own.jerk) own.jerk = settings.jerk_limit.value_or(kUnlimited);
  return own;
}

RateLimits limits_of_group(const Robot& robot, const Rates& rates) {
  RateLimits limits;
  for (int i = 0; i < robot.joint_count(); ++i) {
    const JointRates& own = rates.at(robot.group_joint(i).name);
    limits.velocity.push_back(std::min(own.velocity, kMostRate));
    limits.acceleration.push_back(std::min(*own.acceleration, kMostRate));
    limits.jerk.push_back(*own.jerk <= kMostRate ? *own.jerk : kUnlimited);
  }
  return limits;
}

/// Lowers the limits of joints for the joints that follow them.
void heed_followers(const Robot& robot, const Rates& rates, RateLimits& limits) {
  for (const Joint& joint : robot.joints()) {
    if (!joint.mimic || joint.mimic->multiplier == 0) continue;
    const auto leader = std::ranges::find(robot.group(), joint.mimic->joint);
    if (leader == robot.group().end()) continue;
    const auto i = static_cast<std::size_t>(leader - robot.group().begin());
    const double ratio = std::abs(joint.mimic->multiplier);
    const JointRates& own = rates.at(joint.name);
    limits.velocity[i] = std::min(limits.velocity[i], own.velocity / ratio);
    limits.acceleration[i] = std::min(limits.acceleration[i], *own.acceleration / ratio);
    limits.jerk[i] = std::min(limits.jerk[i], *own.jerk / ratio);
  }
}

Result<void> check_rates(const Robot& robot, const std::vector<double>& rates,
                         std::string_view what, double most = kMostRate) {
  if (as_index(robot.joint_count()) != rates.size()) {
    return fail(ErrorCode::invalid,
                "got {} limits of {}, expected {}: one for each joint in the group of robot '{}'",
                rates.size(), what, robot.joint_count(), robot.name());
  }
  for (int i = 0; i < robot.joint_count(); ++i) {
    const double rate = rates[as_index(i)];
    // Written so that a NaN is refused.
    if (rate >= kLeastRate && rate <= most) continue;
    return fail(ErrorCode::invalid,
                "joint '{}': its limit of {} is {}, expected {} to {}; correct the URDF, or give "
                "limits in a file (--joint-limits, in Python limits)",
                robot.group_joint(i).name, what, rate, kLeastRate, most);
  }
  return {};
}

}  // namespace

Result<void> check_rate_limits(const Robot& robot, const RateLimits& limits) {
  MNEME_TRY(check_rates(robot, limits.velocity, "velocity"));
  MNEME_TRY(check_rates(robot, limits.acceleration, "acceleration"));
  if (limits.jerk.empty()) return {};
  return check_rates(robot, limits.jerk, "jerk", kUnlimited);
}

}  // namespace internal

namespace {

using PositionLimits = std::map<std::string, std::array<double, 2>>;

/// The limits of joints that `text`, of `file`, narrows.
PositionLimits find_narrower(const Robot& robot, const std::string& text, const std::string& file) {
  PositionLimits narrower;
  const internal::InputValue value = internal::parse_yaml(text, file);
  const internal::Input limits = internal::find_limits(internal::Input(value, file));
  internal::visit_joints(limits, robot, [&](const internal::Input& joint, const Joint* own) {
    if (own == nullptr) return;
    const Joint& leader = internal::leader_of(robot, *own);
    const internal::Positions positions = internal::read_positions(joint);
    const bool has_limits = internal::is_free(leader) && leader.type != JointType::continuous;
    if (!has_limits || internal::contain(positions, robot, *own)) return;
    const auto [least, most] = internal::of_leader(*own, positions);
    auto& [lower, upper] =
        narrower.try_emplace(leader.name, std::array{leader.lower, leader.upper}).first->second;
    if (std::max(lower, least) > std::min(upper, most)) {
      joint.fail(ErrorCode::invalid,
                 "expected positions that the limits [{}, {}] of joint '{}' allow, got {} to {}",
                 lower, upper, leader.name, positions.least, positions.most);
    }
    lower = std::max(lower, least);
    upper = std::min(upper, most);
  });
  return narrower;
}

}  // namespace

Result<Robot> narrow_positions(const Robot& robot, const std::string& file) {
  if (file.empty()) return robot;
  const std::string text = MNEME_TRY(internal::read_text_file(file));
  const PositionLimits narrower =
      MNEME_TRY(internal::without_throwing([&] { return find_narrower(robot, text, file); }));
  if (narrower.empty()) return robot;
  const Robot narrowed = robot.with_limits(narrower);
  if (robot.attached().empty()) return narrowed;
  return narrowed.with_attached({robot.attached().begin(), robot.attached().end()});
}

Result<RateLimits> find_rate_limits(const Robot& robot, const TrajectorySettings& settings,
                                    const std::string& file, bool strict) {
  MNEME_TRY(internal::check_ranges(settings));
  internal::Rates rates = internal::rates_of_urdf(robot);
  internal::LimitsFile limits_file(robot, strict);
  if (!file.empty()) {
    MNEME_TRY(internal::without_throwing([&] { limits_file.read(file, rates); }));
  }
  for (auto& [name, own] : rates) own = internal::complete(own, settings);
  RateLimits limits = internal::limits_of_group(robot, rates);
  internal::heed_followers(robot, rates, limits);
  for (double& velocity : limits.velocity) velocity *= settings.velocity_scale;
  for (double& rate : limits.acceleration) rate *= settings.acceleration_scale;
  MNEME_TRY(internal::check_rate_limits(robot, limits));
  limits.warnings = limits_file.warnings(file);
  return limits;
}

}  // namespace mneme
