// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/robot.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "robot/planarity.h"
#include "robot/robot_hash.h"
#include "robot/robot_tree.h"
#include "robot/self_pairs.h"

namespace mneme {
namespace {

std::string movable_names(std::span<const Joint> joints) {
  std::vector<std::string_view> names;
  for (const Joint& joint : joints) {
    if (joint.type != JointType::fixed) names.push_back(joint.name);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

/// The index of a joint that can move.
Result<int> find_movable(std::span<const Joint> joints, const std::string& name) {
  const auto found = std::ranges::find(joints, name, &Joint::name);
  if (found == joints.end()) {
    return fail(ErrorCode::invalid,
                fmt::format("there is no joint '{}'; the movable joints are: {}", name,
                            movable_names(joints)));
  }
  if (found->type == JointType::fixed) {
    return fail(ErrorCode::invalid, fmt::format("joint '{}' is fixed; the movable joints are: {}",
                                                name, movable_names(joints)));
  }
  return static_cast<int>(found - joints.begin());
}

Result<std::vector<int>> choose_group(std::span<const Joint> joints,
                                      const std::vector<std::string>& names) {
  std::vector<int> group;
  if (names.empty()) {
    for (std::size_t i = 0; i < joints.size(); ++i) {
      if (joints[i].type != JointType::fixed) group.push_back(static_cast<int>(i));
    }
    if (group.empty()) return fail(ErrorCode::invalid, "there is no joint that can move");
    return group;
  }
  for (const std::string& name : names) {
    const auto joint = find_movable(joints, name);
    if (!joint) return tl::unexpected(joint.error());
    if (std::ranges::find(group, *joint) != group.end()) {
      return fail(ErrorCode::invalid,
                  fmt::format("joint '{}' stands twice in the planning group", name));
    }
    group.push_back(*joint);
  }
  return group;
}

double within_limits(const Joint& joint, double value) {
  return joint.type == JointType::continuous ? std::remainder(value, 2 * std::numbers::pi)
                                             : std::clamp(value, joint.lower, joint.upper);
}

std::optional<Error> set_fixed_values(std::vector<Joint>& joints, std::span<const int> group,
                                      const std::map<std::string, double>& values) {
  for (Joint& joint : joints) {
    joint.fixed_value = joint.type == JointType::fixed ? 0.0 : within_limits(joint, 0.0);
  }
  for (const auto& [name, value] : values) {
    const auto i = find_movable(joints, name);
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
    Joint& joint = joints[static_cast<std::size_t>(*i)];
    joint.fixed_value = within_limits(joint, value);
  }
  return std::nullopt;
}

Error named(const std::string& robot, const Error& error) {
  return {error.code, fmt::format("robot '{}': {}", robot, error.message)};
}

}  // namespace

Result<Robot> make_robot(Robot::Parts parts, const RobotOptions& options) {
  const std::string name = parts.name;
  auto sorted = internal::sort_tree(std::move(parts));
  if (!sorted) {
    return tl::unexpected(named(name, {ErrorCode::invalid, sorted.error().message}));
  }
  auto group = choose_group(sorted->joints, options.joints);
  if (!group) return tl::unexpected(named(name, group.error()));
  if (const auto error = set_fixed_values(sorted->joints, *group, options.fixed_values)) {
    return tl::unexpected(named(name, *error));
  }
  Robot::Model model;
  model.name = name;
  model.links = std::move(sorted->links);
  model.joints = std::move(sorted->joints);
  model.group = std::move(*group);
  model.self_pairs = internal::derive_self_pairs(model.links, model.joints, model.group);
  model.hash = internal::hash_robot(model.links, model.joints, model.group, model.self_pairs);
  model.is_planar = internal::moves_in_plane(model.links, model.joints, model.group);
  return Robot(std::make_shared<const Robot::Model>(std::move(model)));
}

}  // namespace mneme
