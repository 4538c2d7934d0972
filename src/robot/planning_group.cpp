// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/planning_group.h"

#include "base/as_index.h"
#include "base/fail.h"
#include "robot/held_joints.h"
#include "robot/kinematics.h"
#include "robot/robot_tree.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <utility>

namespace mneme::internal {
namespace {

using Names = std::vector<std::string>;

Names free_names(std::span<const Joint> joints) {
  Names names;
  for (const Joint& joint : joints) {
    if (is_free(joint)) names.push_back(joint.name);
  }
  return names;
}

Names group_names(std::span<const JointGroup> groups) {
  Names names;
  for (const JointGroup& group : groups) names.push_back(group.name);
  return names;
}

Result<std::vector<int>> find_all(std::span<const Joint> joints, const Names& names) {
  std::vector<int> group;
  for (const std::string& name : names) {
    const int joint = MNEME_TRY(find_free_joint(joints, name));
    if (std::ranges::find(group, joint) != group.end()) {
      return fail(ErrorCode::invalid, "joint '{}' appears twice in the planning group", name);
    }
    group.push_back(joint);
  }
  return group;
}

/// Joints by name.
struct NamedGroup {
  Names joints;
  std::string tip = {};
};

/// The joints of "base_link:tip_link", or nothing if one of these links does not exist.
std::optional<NamedGroup> find_chain(const Robot::Parts& parts, const std::string& name) {
  const std::size_t colon = name.find(':');
  if (colon == std::string::npos) return std::nullopt;
  const auto base = find_link(parts.links, name.substr(0, colon));
  const auto tip = find_link(parts.links, name.substr(colon + 1));
  if (!base || !tip) return std::nullopt;
  return NamedGroup{joints_between(parts.links, parts.joints, *base, *tip), name.substr(colon + 1)};
}

Result<NamedGroup> find_named(const Robot::Parts& parts, const std::string& name) {
  std::optional<NamedGroup> found;
  const auto group = std::ranges::find(parts.groups, name, &JointGroup::name);
  if (group != parts.groups.end()) {
    found = NamedGroup{group->joints, group->tip};
  } else {
    found = find_chain(parts, name);
  }
  if (!found) {
    return fail(ErrorCode::invalid,
                "there is no group '{}'; expected {}{}the two links of a chain as "
                "base_link:tip_link",
                name, fmt::join(group_names(parts.groups), ", "),
                parts.groups.empty() ? "" : " or ");
  }
  if (found->joints.empty()) {
    return fail(ErrorCode::invalid,
                "group '{}' has no joint to plan for; the robot's movable joints are: {}{}{}", name,
                fmt::join(free_names(parts.joints), ", "), parts.warnings.empty() ? "" : "; ",
                fmt::join(parts.warnings, "; "));
  }
  return *std::move(found);
}

/// The only movable group that is no end effector. Groups of equal joints count as one.
Result<NamedGroup> find_only(const Robot::Parts& parts) {
  std::vector<JointGroup> fitting;
  for (const JointGroup& group : parts.groups) {
    const bool is_new =
        std::ranges::find(fitting, group.joints, &JointGroup::joints) == fitting.end();
    if (!group.joints.empty() && !group.is_end_effector && is_new) fitting.push_back(group);
  }
  if (fitting.size() == 1) return NamedGroup{fitting.front().joints, fitting.front().tip};
  if (fitting.empty()) {
    return fail(ErrorCode::invalid,
                "no group of the SRDF ({}) is movable and not an end effector; name the "
                "joints to plan for{}{}",
                fmt::join(group_names(parts.groups), ", "), parts.warnings.empty() ? "" : "; ",
                fmt::join(parts.warnings, "; "));
  }
  return fail(ErrorCode::invalid, "the SRDF has several groups to plan for: {}; name one",
              fmt::join(group_names(fitting), ", "));
}

}  // namespace

Result<int> find_free_joint(std::span<const Joint> joints, const std::string& name) {
  const auto found = std::ranges::find(joints, name, &Joint::name);
  std::string fault;
  if (found == joints.end()) {
    fault = fmt::format("there is no joint '{}'", name);
  } else if (found->held) {
    std::vector<std::string> values;
    for (const auto& value : held_values(*found, {})) values.push_back(value.first);
    fault = fmt::format("joint '{0}' is {1}: its fixed values are {2}", name,
                        found->held->is_planar ? "planar" : "floating", fmt::join(values, ", "));
  } else if (found->type == JointType::fixed) {
    fault = fmt::format("joint '{}' is fixed", name);
  } else if (found->mimic) {
    fault = fmt::format("joint '{}' follows joint '{}'", name,
                        joints[static_cast<std::size_t>(found->mimic->joint)].name);
  } else {
    return static_cast<int>(found - joints.begin());
  }
  return fail(ErrorCode::invalid, "{}; the movable joints are: {}", fault,
              fmt::join(free_names(joints), ", "));
}

Names joints_between(std::span<const Link> links, std::span<const Joint> joints, int base,
                     int tip) {
  std::vector<bool> is_between(joints.size(), false);
  // In tree order the larger index is never an ancestor of the other.
  while (base != tip) {
    int& lower = std::max(base, tip) == tip ? tip : base;
    const int joint = links[as_index(lower)].parent_joint;
    is_between[as_index(joint)] = true;
    lower = joints[as_index(joint)].parent_link;
  }
  Names names;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (is_between[i] && is_free(joints[i])) names.push_back(joints[i].name);
  }
  return names;
}

Result<PlanningGroup> choose_group(const Robot::Parts& parts, const RobotOptions& options) {
  const Names all = free_names(parts.joints);
  if (all.empty()) return fail(ErrorCode::invalid, "there is no joint that can move");
  NamedGroup named{options.joints};
  if (named.joints.empty() && !options.group.empty()) {
    named = MNEME_TRY(find_named(parts, options.group));
  } else if (named.joints.empty() && !parts.groups.empty()) {
    named = MNEME_TRY(find_only(parts));
  } else if (named.joints.empty()) {
    named.joints = all;
  }
  return PlanningGroup{MNEME_TRY(find_all(parts.joints, named.joints)), std::move(named.tip)};
}

}  // namespace mneme::internal
