// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/robot.h"

#include "base/as_index.h"
#include "base/fail.h"
#include "robot/held_joints.h"
#include "robot/kinematics.h"
#include "robot/planning_group.h"
#include "robot/robot_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

namespace mneme {
std::optional<int> Robot::find_link(std::string_view name) const {
  return internal::find_link(links(), name);
}

std::optional<int> Robot::find_frame(std::string_view name) const {
  const auto link = find_link(name);
  return !link && !name.empty() && name == root_frame() ? std::optional(0) : link;
}

std::vector<std::string> Robot::joint_names() const {
  std::vector<std::string> names;
  for (int i = 0; i < joint_count(); ++i) names.push_back(group_joint(i).name);
  return names;
}

std::vector<Transform> Robot::link_poses(std::span<const double> q) const {
  return internal::forward_kinematics(joints(), group(), q);
}

std::string Robot::kinematics_hash() const { return internal::hash_kinematics(joints(), group()); }

namespace {

double within_limits(const Joint& joint, double value) {
  return joint.type == JointType::continuous ? std::remainder(value, 2 * std::numbers::pi)
                                             : std::clamp(value, joint.lower, joint.upper);
}

/// True if a follower of the continuous joint `leader` depends on its number of turns.
bool has_jumps(std::span<const Joint> joints, int leader, const Joint& follower) {
  if (!follower.mimic || follower.mimic->joint != leader) return false;
  if (joints[internal::as_index(leader)].type != JointType::continuous) return false;
  const double multiplier = follower.mimic->multiplier;
  return multiplier != 0 &&
         !(internal::is_turning(follower) && multiplier == std::round(multiplier));
}

Result<void> refuse_jumps(std::span<const Joint> joints, std::span<const int> group) {
  for (const int leader : group) {
    for (const Joint& follower : joints) {
      if (!has_jumps(joints, leader, follower)) continue;
      return fail(
          ErrorCode::invalid,
          "joint '{0}' jumps where the continuous joint '{1}' that it follows wraps around; "
          "expected a rotating joint and an integer multiplier, got {2}; make '{1}' "
          "revolute with limits, or plan for joints without it (--group, joints)",
          follower.name, joints[internal::as_index(leader)].name, follower.mimic->multiplier);
    }
  }
  return {};
}

Result<void> set_fixed_values(std::vector<Joint>& joints, std::span<const int> group,
                              std::map<std::string, double> values,
                              std::vector<std::string>& warnings) {
  MNEME_TRY(internal::hold_joints(joints, values));
  for (Joint& joint : joints) {
    joint.fixed_value = joint.type == JointType::fixed ? 0.0 : within_limits(joint, 0.0);
  }
  for (const auto& [name, value] : values) {
    const int i = MNEME_TRY(internal::find_free_joint(joints, name));
    if (std::ranges::find(group, i) != group.end()) {
      return fail(ErrorCode::invalid, "joint '{}' has a fixed value but is in the planning group",
                  name);
    }
    if (!std::isfinite(value)) {
      return fail(ErrorCode::invalid, "the fixed value of joint '{}' is {}, expected a number",
                  name, value);
    }
    Joint& joint = joints[internal::as_index(i)];
    joint.fixed_value = value;
    const bool counts_turns = std::ranges::any_of(
        joints, [&](const Joint& follower) { return has_jumps(joints, i, follower); });
    if (counts_turns) continue;
    const double within = within_limits(joint, value);
    if (joint.type == JointType::continuous ||
        std::abs(within - value) <= internal::kLimitTolerance) {
      joint.fixed_value = within;
      continue;
    }
    warnings.push_back(fmt::format(
        "the fixed value {} of joint '{}' is outside its limits [{}, {}]; it is used anyway", value,
        name, joint.lower, joint.upper));
  }
  for (Joint& joint : joints) {
    if (!joint.mimic) continue;
    const Joint& leader = joints[internal::as_index(joint.mimic->joint)];
    joint.fixed_value = joint.mimic->multiplier * leader.fixed_value + joint.mimic->offset;
  }
  return {};
}

Result<void> refuse_solids(std::span<const Link> links) {
  const auto link =
      std::ranges::find_if(links, [](const Link& each) { return !each.solids.empty(); });
  if (link == links.end()) return {};
  return fail(ErrorCode::unsupported,
              "link '{}' has boxes, cylinders or meshes; approximate them by spheres first "
              "(`mneme robot spheres`, load_approximated_robot)",
              link->name);
}

using NamedPairs = std::vector<std::pair<std::string, std::string>>;

/// Indices of links by their names. `purpose` completes the message "links 'a' and 'b' are ..".
Result<internal::LinkPairs> find_pairs(std::span<const Link> all, const NamedPairs& named,
                                       std::string_view purpose) {
  std::map<std::string_view, int> links;
  for (const Link& link : all) links.emplace(link.name, static_cast<int>(links.size()));
  internal::LinkPairs pairs;
  for (const auto& [a, b] : named) {
    const auto first = links.find(a), second = links.find(b);
    if (first == links.end() || second == links.end()) {
      return fail(ErrorCode::invalid, "links '{}' and '{}' are {}, but there is no link '{}'", a, b,
                  purpose, first == links.end() ? a : b);
    }
    pairs.push_back(std::minmax(first->second, second->second));
  }
  return pairs;
}

/// `joints` are those of the planning group.
void warn_of_virtual_joint(const Robot::Parts& parts, const RobotOptions& options,
                           std::span<const std::string> joints,
                           std::vector<std::string>& warnings) {
  const auto group = std::ranges::find_if(parts.groups, [&](const JointGroup& each) {
    return options.group.empty() ? std::ranges::equal(each.joints, joints)
                                 : each.name == options.group;
  });
  if (group == parts.groups.end() || group->virtual_joint.empty()) return;
  if (!options.joints.empty()) return;
  warnings.push_back(fmt::format(
      "group '{}' has the virtual joint '{}', which cannot be planned for: the base stays where it "
      "is",
      group->name, group->virtual_joint));
}

/// Pairs of links that may touch.
Result<internal::LinkPairs> find_allowed(const Robot::Parts& parts, std::span<const int> group,
                                         const RobotOptions& options) {
  auto named = parts.allowed_pairs.value_or(NamedPairs());
  named.insert(named.end(), options.allowed_pairs.begin(), options.allowed_pairs.end());
  internal::LinkPairs pairs = MNEME_TRY(find_pairs(parts.links, named, "allowed to touch"));
  if (parts.allowed_pairs) return pairs;
  const auto neighbours = internal::find_neighbours(parts.links, parts.joints, group);
  pairs.insert(pairs.end(), neighbours.begin(), neighbours.end());
  return pairs;
}

/// Removes pairs that are not among `self_pairs`.
void keep_checked(const internal::LinkPairs& self_pairs, internal::LinkPairs& pairs) {
  const std::set<std::pair<int, int>> wanted(pairs.begin(), pairs.end());
  std::set<std::pair<int, int>> checked;
  for (const auto& pair : self_pairs) {
    if (wanted.contains(pair)) checked.insert(pair);
  }
  std::erase_if(pairs, [&](const auto& pair) { return !checked.contains(pair); });
}

/// Very wide limits are probably degrees.
void warn_of_wide_limits(std::span<const Joint> joints, std::vector<std::string>& warnings) {
  constexpr double kWidest = 4 * std::numbers::pi;
  for (const Joint& joint : joints) {
    if (joint.type != JointType::revolute || joint.mimic) continue;
    if (joint.lower >= -kWidest && joint.upper <= kWidest) continue;
    warnings.push_back(
        fmt::format("joint '{}': its limits [{}, {}] exceed two turns; expected radians",
                    joint.name, joint.lower, joint.upper));
  }
}

/// Limits of followers are not checked during planning.
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

}  // namespace

Robot Robot::with_limits(const std::map<std::string, std::array<double, 2>>& limits) const {
  Model model = *bare_model();
  for (Joint& joint : model.joints) {
    const auto own = limits.find(joint.name);
    if (own == limits.end()) continue;
    joint.lower = own->second[0];
    joint.upper = own->second[1];
  }
  model.hash = internal::hash_robot(model.links, model.joints, model.group, model.self_pairs,
                                    model.exact_pairs);
  return Robot(std::make_shared<const Model>(std::move(model)));
}

Result<Robot> make_robot(Robot::Parts parts, const RobotOptions& options) {
  const std::string name = parts.name;
  const auto make = [&]() -> Result<Robot> {
    Robot::Parts sorted = MNEME_TRY(
        internal::sort_tree(std::move(parts)).map_error([](const internal::PartsFault& f) {
          return Error{ErrorCode::invalid, f.message};
        }));
    MNEME_TRY(refuse_solids(sorted.links));
    Robot::Model model;
    model.name = name;
    auto chosen = MNEME_TRY(internal::choose_group(sorted, options));
    model.group = std::move(chosen.joints);
    model.tip = std::move(chosen.tip);
    std::vector<std::string> names;
    for (const int i : model.group) names.push_back(sorted.joints[internal::as_index(i)].name);
    warn_of_virtual_joint(sorted, options, names, sorted.warnings);
    MNEME_TRY(refuse_jumps(sorted.joints, model.group));
    MNEME_TRY(set_fixed_values(sorted.joints, model.group, options.fixed_values, sorted.warnings));
    warn_of_wide_limits(sorted.joints, sorted.warnings);
    warn_of_followers(sorted.joints, model.group, sorted.warnings);
    model.allowed_pairs = MNEME_TRY(find_allowed(sorted, model.group, options));
    model.exact_pairs =
        MNEME_TRY(find_pairs(sorted.links, sorted.exact_pairs, "checked by exact geometry"));
    model.links = std::move(sorted.links);
    model.joints = std::move(sorted.joints);
    model.self_pairs =
        internal::derive_self_pairs(model.links, model.joints, model.group, model.allowed_pairs);
    keep_checked(model.self_pairs, model.exact_pairs);
    model.hash = internal::hash_robot(model.links, model.joints, model.group, model.self_pairs,
                                      model.exact_pairs);
    model.is_planar = internal::moves_in_plane(model.links, model.joints, model.group);
    model.warnings = std::move(sorted.warnings);
    model.states = std::move(sorted.states);
    model.root_frame = std::move(sorted.root_frame);
    return Robot(std::make_shared<const Robot::Model>(std::move(model)));
  };
  return make().map_error(internal::naming(fmt::format("robot '{}'", name)));
}

}  // namespace mneme
