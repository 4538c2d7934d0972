// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/robot.h"

#include "base/as_index.h"
#include "robot/kinematics.h"
#include "robot/planning_group.h"
#include "robot/robot_facts.h"
#include "robot/robot_tree.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace mneme {
namespace internal {

Transform joint_motion(const Joint& joint, double value) {
  switch (joint.type) {
    case JointType::fixed:
      return {};
    case JointType::prismatic:
      return {Eigen::Matrix3d::Identity(), value * joint.axis};
    case JointType::revolute:
    case JointType::continuous:
      return {rotation_about(joint.axis, value), Vec3::Zero()};
  }
  return {};
}

std::vector<double> joint_values(std::span<const Joint> joints, std::span<const int> group,
                                 std::span<const double> q) {
  assert(q.size() == group.size());
  std::vector<double> values(joints.size());
  std::ranges::transform(joints, values.begin(), &Joint::fixed_value);
  for (std::size_t i = 0; i < group.size(); ++i) values[as_index(group[i])] = q[i];
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const std::optional<Mimic>& mimic = joints[i].mimic;
    if (!mimic) continue;
    values[i] = mimic->multiplier * values[as_index(mimic->joint)] + mimic->offset;
  }
  return values;
}

std::vector<Transform> forward_kinematics(std::span<const Joint> joints, std::span<const int> group,
                                          std::span<const double> q) {
  const std::vector<double> values = joint_values(joints, group, q);
  std::vector<Transform> poses(joints.size() + 1);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const Joint& joint = joints[i];
    const Transform& parent = poses[as_index(joint.parent_link)];
    poses[as_index(joint.child_link)] = parent * joint.origin * joint_motion(joint, values[i]);
  }
  return poses;
}

std::optional<int> find_link(std::span<const Link> links, std::string_view name) {
  const auto found = std::ranges::find(links, name, &Link::name);
  if (found == links.end()) return std::nullopt;
  return static_cast<int>(found - links.begin());
}

}  // namespace internal

std::optional<int> Robot::find_link(std::string_view name) const {
  return internal::find_link(links(), name);
}

std::vector<Transform> Robot::link_poses(std::span<const double> q) const {
  return internal::forward_kinematics(joints(), group(), q);
}

std::string Robot::kinematics_hash() const { return internal::hash_kinematics(joints(), group()); }

namespace {

/// Radians or metres beyond a limit: less is a rounding error of whoever wrote the value.
constexpr double kLimitTolerance = 1e-5;

/// `angle` in [-pi, pi), without rounding.
double wrapped(double angle) {
  const double result = std::remainder(angle, 2 * std::numbers::pi);
  return result >= std::numbers::pi ? -std::numbers::pi : result;
}

bool is_within_limits(const Joint& joint, double value) {
  return joint.type == JointType::continuous ||
         (value >= joint.lower - kLimitTolerance && value <= joint.upper + kLimitTolerance);
}

}  // namespace

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
        fault = fmt::format(
            "state \"{}\" is of group {} and has no value of joint {}, which is planned for",
            wanted, state.group, joint);
        break;
      }
      q.push_back(value->second);
    }
    if (std::ssize(q) == joint_count()) return q;
  }
  if (!fault.empty()) return fail(ErrorCode::invalid, fault);
  return fail(
      ErrorCode::invalid,
      fmt::format("expected a state that the SRDF of robot {} names ({}), got \"{}\"", name(),
                  known.empty() ? "it names none" : fmt::format("{}", fmt::join(known, ", ")),
                  wanted));
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

namespace {

double within_limits(const Joint& joint, double value) {
  return joint.type == JointType::continuous ? std::remainder(value, 2 * std::numbers::pi)
                                             : std::clamp(value, joint.lower, joint.upper);
}

std::optional<Error> set_fixed_values(std::vector<Joint>& joints, std::span<const int> group,
                                      const std::map<std::string, double>& values,
                                      std::vector<std::string>& warnings) {
  for (Joint& joint : joints) {
    joint.fixed_value = joint.type == JointType::fixed ? 0.0 : within_limits(joint, 0.0);
  }
  for (const auto& [name, value] : values) {
    const auto i = internal::find_free_joint(joints, name);
    if (!i) return i.error();
    if (std::ranges::find(group, *i) != group.end()) {
      return Error{ErrorCode::invalid,
                   fmt::format("joint '{}' has a fixed value but is in the planning group", name)};
    }
    if (!std::isfinite(value)) {
      return Error{
          ErrorCode::invalid,
          fmt::format("the fixed value of joint '{}' is {}, expected a number", name, value)};
    }
    Joint& joint = joints[internal::as_index(*i)];
    joint.fixed_value = within_limits(joint, value);
    const bool is_beyond = joint.type != JointType::continuous &&
                           std::abs(joint.fixed_value - value) > kLimitTolerance;
    if (!is_beyond) continue;
    // The joint stands where whoever saw it says, not where its limits would have it.
    joint.fixed_value = value;
    warnings.push_back(fmt::format(
        "the fixed value {} of joint '{}' is outside its limits [{}, {}]; it is taken as it is",
        value, name, joint.lower, joint.upper));
  }
  for (Joint& joint : joints) {
    if (!joint.mimic) continue;
    const Joint& leader = joints[internal::as_index(joint.mimic->joint)];
    joint.fixed_value = joint.mimic->multiplier * leader.fixed_value + joint.mimic->offset;
  }
  return std::nullopt;
}

std::optional<Error> refuse_solids(std::span<const Link> links) {
  for (const Link& link : links) {
    if (link.solids.empty()) continue;
    return Error{
        ErrorCode::unsupported,
        fmt::format(
            "link '{}' has collision geometry besides spheres and capsules; "
            "approximate it by spheres first (`mneme robot spheres`, load_approximated_robot)",
            link.name)};
  }
  return std::nullopt;
}

/// Pairs of links that may touch.
Result<internal::LinkPairs> find_allowed(const Robot::Parts& parts, std::span<const int> group,
                                         const RobotOptions& options) {
  std::map<std::string_view, int> links;
  for (const Link& link : parts.links) links.emplace(link.name, static_cast<int>(links.size()));
  internal::LinkPairs pairs;
  if (!parts.allowed_pairs) pairs = internal::find_neighbours(parts.links, parts.joints, group);
  using NamedPairs = std::vector<std::pair<std::string, std::string>>;
  for (const NamedPairs& allowed :
       {parts.allowed_pairs.value_or(NamedPairs()), options.allowed_pairs}) {
    for (const auto& [a, b] : allowed) {
      const auto first = links.find(a), second = links.find(b);
      if (first == links.end() || second == links.end()) {
        return fail(ErrorCode::invalid,
                    fmt::format("links '{}' and '{}' are allowed to touch, but there is no link "
                                "'{}'",
                                a, b, first == links.end() ? a : b));
      }
      pairs.emplace_back(first->second, second->second);
    }
  }
  return pairs;
}

/// Limits that a revolute joint hardly has, unless they are degrees.
void warn_of_wide_limits(std::span<const Joint> joints, std::vector<std::string>& warnings) {
  constexpr double kWidest = 4 * std::numbers::pi;
  for (const Joint& joint : joints) {
    if (joint.type != JointType::revolute || joint.mimic) continue;
    if (joint.lower >= -kWidest && joint.upper <= kWidest) continue;
    warnings.push_back(
        fmt::format("joint '{}': its limits [{}, {}] are beyond two turns; expected radians",
                    joint.name, joint.lower, joint.upper));
  }
}

/// Values of followers are not limited: a plan may lead them beyond what their own limits say.
void warn_of_followers(std::span<const Joint> joints, std::span<const int> group,
                       std::vector<std::string>& warnings) {
  constexpr double kTolerance = 1e-6;
  for (const Joint& joint : joints) {
    const bool is_limited = joint.type != JointType::continuous && joint.lower < joint.upper;
    if (!joint.mimic || !is_limited) continue;
    if (std::ranges::find(group, joint.mimic->joint) == group.end()) continue;
    const Joint& leader = joints[static_cast<std::size_t>(joint.mimic->joint)];
    if (leader.type == JointType::continuous) continue;
    const auto value_at = [&](double q) {
      return joint.mimic->multiplier * q + joint.mimic->offset;
    };
    const auto [least, most] = std::minmax({value_at(leader.lower), value_at(leader.upper)});
    if (least >= joint.lower - kTolerance && most <= joint.upper + kTolerance) continue;
    warnings.push_back(fmt::format(
        "joint '{}' follows '{}' from {:.4g} to {:.4g}, beyond its own limits [{:.4g}, {:.4g}]: "
        "expected limits of '{}' that keep it within them",
        joint.name, leader.name, least, most, joint.lower, joint.upper, leader.name));
  }
}

Error named(const std::string& robot, const Error& error) {
  return {error.code, fmt::format("robot '{}': {}", robot, error.message)};
}

}  // namespace

Result<Robot> make_robot(Robot::Parts parts, const RobotOptions& options) {
  const std::string name = parts.name;
  auto sorted = internal::sort_tree(std::move(parts));
  if (!sorted) return tl::unexpected(named(name, {ErrorCode::invalid, sorted.error().message}));
  if (const auto error = refuse_solids(sorted->links)) return tl::unexpected(named(name, *error));
  auto group = internal::choose_group(*sorted, options);
  if (!group) return tl::unexpected(named(name, group.error()));
  if (const auto error =
          set_fixed_values(sorted->joints, *group, options.fixed_values, sorted->warnings)) {
    return tl::unexpected(named(name, *error));
  }
  warn_of_wide_limits(sorted->joints, sorted->warnings);
  warn_of_followers(sorted->joints, *group, sorted->warnings);
  const auto allowed = find_allowed(*sorted, *group, options);
  if (!allowed) return tl::unexpected(named(name, allowed.error()));
  Robot::Model model;
  model.name = name;
  model.links = std::move(sorted->links);
  model.joints = std::move(sorted->joints);
  model.group = std::move(*group);
  model.self_pairs = internal::derive_self_pairs(model.links, model.joints, model.group, *allowed);
  model.hash = internal::hash_robot(model.links, model.joints, model.group, model.self_pairs);
  model.is_planar = internal::moves_in_plane(model.links, model.joints, model.group);
  model.warnings = std::move(sorted->warnings);
  model.states = std::move(sorted->states);
  return Robot(std::make_shared<const Robot::Model>(std::move(model)));
}

}  // namespace mneme
