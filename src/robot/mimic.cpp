// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/mimic.h"

#include <cmath>

#include <fmt/format.h>

namespace mneme::internal {
namespace {

std::size_t index(int i) { return static_cast<std::size_t>(i); }

bool is_turning(const Joint& joint) {
  return joint.type == JointType::revolute || joint.type == JointType::continuous;
}

std::optional<std::string> describe_fault(const std::vector<Joint>& joints, const Mimic& mimic) {
  if (mimic.joint < 0 || index(mimic.joint) >= joints.size()) {
    return fmt::format("it follows joint {}, which does not exist", mimic.joint);
  }
  if (!std::isfinite(mimic.multiplier) || !std::isfinite(mimic.offset)) {
    return fmt::format("its multiplier {} and offset {} are not finite", mimic.multiplier,
                       mimic.offset);
  }
  return std::nullopt;
}

/// Follows the chain from `first` to a joint that follows none. A chain longer than all joints is a
/// loop.
std::optional<Mimic> folded(const std::vector<Joint>& joints, const Mimic& first) {
  Mimic result = first;
  for (std::size_t step = 0; step < joints.size(); ++step) {
    const std::optional<Mimic>& next = joints[index(result.joint)].mimic;
    if (!next) return result;
    result.offset += result.multiplier * next->offset;
    result.multiplier *= next->multiplier;
    result.joint = next->joint;
  }
  return std::nullopt;
}

std::optional<std::string> describe_jump(const Joint& joint, const Joint& leader) {
  if (leader.type != JointType::continuous) return std::nullopt;
  const double multiplier = joint.mimic->multiplier;
  if (multiplier == 0 || (is_turning(joint) && multiplier == std::round(multiplier))) {
    return std::nullopt;
  }
  return fmt::format(
      "it jumps where the continuous joint '{}' that it follows wraps round; expected a turning "
      "joint and a whole multiplier, not {}",
      leader.name, multiplier);
}

}  // namespace

std::optional<std::pair<int, std::string>> fold_mimics(std::vector<Joint>& joints) {
  for (std::size_t i = 0; i < joints.size(); ++i) {
    Joint& joint = joints[i];
    if (joint.type == JointType::fixed) joint.mimic.reset();
    if (!joint.mimic) continue;
    if (auto fault = describe_fault(joints, *joint.mimic)) {
      return std::pair(static_cast<int>(i), *std::move(fault));
    }
  }
  for (std::size_t i = 0; i < joints.size(); ++i) {
    Joint& joint = joints[i];
    if (!joint.mimic) continue;
    const auto mimic = folded(joints, *joint.mimic);
    if (!mimic)
      return std::pair(static_cast<int>(i), std::string("the joints that it follows form a loop"));
    joint.mimic = mimic;
    if (auto fault = describe_fault(joints, *mimic)) {
      return std::pair(static_cast<int>(i), *std::move(fault));
    }
    if (auto fault = describe_jump(joint, joints[index(mimic->joint)])) {
      return std::pair(static_cast<int>(i), *std::move(fault));
    }
  }
  return std::nullopt;
}

std::vector<bool> find_moving(std::span<const Joint> joints, std::span<const int> group) {
  std::vector<bool> is_moving(joints.size(), false);
  for (const int joint : group) is_moving[index(joint)] = true;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const std::optional<Mimic>& mimic = joints[i].mimic;
    if (mimic && mimic->multiplier != 0) is_moving[i] = is_moving[index(mimic->joint)];
  }
  return is_moving;
}

}  // namespace mneme::internal
