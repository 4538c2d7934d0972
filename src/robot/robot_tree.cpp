// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/robot_tree.h"

#include "base/as_index.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

namespace mneme::internal {
std::optional<int> find_link(std::span<const Link> links, std::string_view name) {
  const auto found = std::ranges::find(links, name, &Link::name);
  if (found == links.end()) return std::nullopt;
  return static_cast<int>(found - links.begin());
}

namespace {

std::optional<std::string> describe_fault(const std::vector<Joint>& joints, const Mimic& mimic) {
  if (mimic.joint < 0 || as_index(mimic.joint) >= joints.size()) {
    return fmt::format("it follows joint {}, which does not exist", mimic.joint);
  }
  constexpr double kMost = 1e6;
  // Written so that NaN is refused.
  if (!(std::abs(mimic.multiplier) <= kMost && std::abs(mimic.offset) <= kMost)) {
    return fmt::format("its multiplier {} and offset {} are not both within {}", mimic.multiplier,
                       mimic.offset, kMost);
  }
  return std::nullopt;
}

/// Refuses values at which kernels cannot place a link.
std::optional<std::string> describe_reach(const Joint& leader, const Mimic& mimic) {
  constexpr double kMost = 1e4;
  double farthest = std::numbers::pi;
  if (leader.type != JointType::continuous) {
    farthest = std::max(std::abs(leader.lower), std::abs(leader.upper));
  }
  const double reach = std::abs(mimic.multiplier) * farthest + std::abs(mimic.offset);
  if (reach <= kMost || !std::isfinite(farthest)) return std::nullopt;
  return fmt::format(
      "with multiplier {}, offset {} and the limits of joint '{}' it would move to {:.4g}, beyond "
      "{:.4g}",
      mimic.multiplier, mimic.offset, leader.name, reach, kMost);
}

/// Follows the chain from `first` to a free joint. Nothing for a loop.
std::optional<Mimic> folded(const std::vector<Joint>& joints, const Mimic& first) {
  Mimic result = first;
  for (std::size_t step = 0; step < joints.size(); ++step) {
    const std::optional<Mimic>& next = joints[as_index(result.joint)].mimic;
    if (!next) return result;
    result.offset += result.multiplier * next->offset;
    result.multiplier *= next->multiplier;
    result.joint = next->joint;
  }
  return std::nullopt;
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
    std::optional<std::string> fault = "the joints that it follows form a loop";
    if (mimic) {
      joint.mimic = mimic;
      fault = describe_fault(joints, *mimic);
      if (!fault) fault = describe_reach(joints[as_index(mimic->joint)], *mimic);
    }
    if (fault) return std::pair(static_cast<int>(i), *std::move(fault));
  }
  return std::nullopt;
}

namespace {

/// Bounds the memory for pairs of links.
constexpr std::size_t kMaxLinkCount = 4096;
constexpr double kMinAxisNorm = 1e-9;

using Fault = std::optional<PartsFault>;

template <class Part>
std::optional<std::size_t> find_doubled_name(const std::vector<Part>& parts) {
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (!names.insert(parts[i].name).second) return i;
  }
  return std::nullopt;
}

/// Metres: far beyond any robot, and sums of lengths stay accurate.
constexpr double kFarthest = 1e6;

bool is_position(const Vec3& p) { return p.allFinite() && p.cwiseAbs().maxCoeff() <= kFarthest; }
bool is_radius(double value) { return value >= 0 && value <= kFarthest; }

}  // namespace

std::optional<std::string> describe_shape_fault(const Link& link) {
  const auto beyond = [](const char* what) {
    return fmt::format("{} is not within {} m", what, kFarthest);
  };
  const auto wrong_radius = [](const char* what, double radius) {
    return fmt::format("a {} has the radius {}, expected 0 to 1e6", what, radius);
  };
  for (const Sphere& sphere : link.spheres) {
    if (!is_position(sphere.center)) return beyond("the centre of a sphere");
    if (!is_radius(sphere.radius)) return wrong_radius("sphere", sphere.radius);
  }
  for (const Capsule& capsule : link.capsules) {
    if (!is_position(capsule.a) || !is_position(capsule.b)) return beyond("an end of a capsule");
    if (!is_radius(capsule.radius)) return wrong_radius("capsule", capsule.radius);
  }
  return std::nullopt;
}

namespace {

bool has_limits(JointType type) {
  return type == JointType::revolute || type == JointType::prismatic;
}

std::optional<std::string> describe_motion_fault(const Joint& joint) {
  if (!joint.origin.rotation.allFinite() || !is_position(joint.origin.translation)) {
    return fmt::format("its origin is not within {} m", kFarthest);
  }
  if (joint.type == JointType::fixed && !joint.held) return std::nullopt;
  const double norm = joint.axis.norm();
  if (!std::isfinite(norm) || norm < kMinAxisNorm) {
    return fmt::format("its axis ({}, {}, {}) is no direction", joint.axis.x(), joint.axis.y(),
                       joint.axis.z());
  }
  if (!has_limits(joint.type)) return std::nullopt;
  if (!std::isfinite(joint.lower) || !std::isfinite(joint.upper)) {
    return fmt::format("its limits [{}, {}] are not finite", joint.lower, joint.upper);
  }
  if (joint.lower > joint.upper) {
    return fmt::format("its lower limit {} is above its upper limit {}", joint.lower, joint.upper);
  }
  return std::nullopt;
}

Fault check_joint(const Joint& joint, int i, int link_count) {
  for (const int link : {joint.parent_link, joint.child_link}) {
    if (link < 0 || link >= link_count) {
      return PartsFault{fmt::format("joint '{}': there is no link {}", joint.name, link), -1, i};
    }
  }
  if (const auto fault = describe_motion_fault(joint)) {
    return PartsFault{fmt::format("joint '{}': {}", joint.name, *fault), -1, i};
  }
  return std::nullopt;
}

Fault check_values(const Robot::Parts& parts) {
  if (parts.links.empty()) return PartsFault{"there is no link"};
  if (parts.links.size() > kMaxLinkCount) {
    return PartsFault{
        fmt::format("there are {} links, expected at most {}", parts.links.size(), kMaxLinkCount)};
  }
  if (const auto i = find_doubled_name(parts.links)) {
    return PartsFault{fmt::format("link '{}' is defined twice", parts.links[*i].name),
                      static_cast<int>(*i)};
  }
  if (const auto i = find_doubled_name(parts.joints)) {
    return PartsFault{fmt::format("joint '{}' is defined twice", parts.joints[*i].name), -1,
                      static_cast<int>(*i)};
  }
  for (std::size_t i = 0; i < parts.links.size(); ++i) {
    const Link& link = parts.links[i];
    if (const auto fault = describe_shape_fault(link)) {
      return PartsFault{fmt::format("link '{}': {}", link.name, *fault), static_cast<int>(i)};
    }
  }
  for (std::size_t i = 0; i < parts.joints.size(); ++i) {
    if (auto fault = check_joint(parts.joints[i], static_cast<int>(i),
                                 static_cast<int>(parts.links.size()))) {
      return fault;
    }
  }
  return std::nullopt;
}

Fault fold_followers(Robot::Parts& parts) {
  const auto fault = fold_mimics(parts.joints);
  if (!fault) return std::nullopt;
  const auto& [joint, what] = *fault;
  return PartsFault{fmt::format("joint '{}': {}", parts.joints[as_index(joint)].name, what), -1,
                    joint};
}

Fault assign_parents(Robot::Parts& parts) {
  for (Link& link : parts.links) link.parent_joint = -1;
  for (std::size_t i = 0; i < parts.joints.size(); ++i) {
    Link& child = parts.links[as_index(parts.joints[i].child_link)];
    if (child.parent_joint >= 0) {
      return PartsFault{
          fmt::format("link '{}' is the child of two joints, '{}' and '{}'", child.name,
                      parts.joints[as_index(child.parent_joint)].name, parts.joints[i].name),
          -1, static_cast<int>(i)};
    }
    child.parent_joint = static_cast<int>(i);
  }
  return std::nullopt;
}

/// The loop above `link`, which has no root.
PartsFault describe_loop(const Robot::Parts& parts, int link) {
  const auto parent_of = [&](int child) {
    return parts.joints[as_index(parts.links[as_index(child)].parent_joint)].parent_link;
  };
  for (std::size_t i = 0; i < parts.links.size(); ++i) link = parent_of(link);
  std::string names;
  const int first = link;
  int count = 0;
  do {
    const int joint = parts.links[as_index(link)].parent_joint;
    if (++count <= 8) names += fmt::format(" '{}'", parts.joints[as_index(joint)].name);
    link = parent_of(link);
  } while (link != first);
  return {fmt::format("{} joint(s) form a loop:{}{}", count, names, count > 8 ? " ..." : ""), -1,
          parts.links[as_index(first)].parent_joint};
}

tl::expected<int, PartsFault> find_root(const Robot::Parts& parts) {
  int root = -1;
  for (std::size_t i = 0; i < parts.links.size(); ++i) {
    if (parts.links[i].parent_joint >= 0) continue;
    if (root >= 0) {
      return tl::unexpected(PartsFault{
          fmt::format("there are several root links: neither '{}' nor '{}' is the child of a joint",
                      parts.links[as_index(root)].name, parts.links[i].name),
          static_cast<int>(i)});
    }
    root = static_cast<int>(i);
  }
  if (root < 0) return tl::unexpected(describe_loop(parts, 0));
  return root;
}

/// Joints depth first; iterative, since chains may be long.
std::vector<int> joints_in_order(const Robot::Parts& parts, int root) {
  std::vector<std::vector<int>> below(parts.links.size());
  for (std::size_t i = parts.joints.size(); i-- > 0;) {
    below[as_index(parts.joints[i].parent_link)].push_back(static_cast<int>(i));
  }
  std::vector<int> order;
  std::vector<int> waiting = below[as_index(root)];
  while (!waiting.empty()) {
    const int joint = waiting.back();
    waiting.pop_back();
    order.push_back(joint);
    const std::vector<int>& next = below[as_index(parts.joints[as_index(joint)].child_link)];
    waiting.insert(waiting.end(), next.begin(), next.end());
  }
  return order;
}

/// The joint with a unit axis and its type's limits.
Joint canonical(Joint joint) {
  if (joint.type != JointType::fixed || joint.held) joint.axis.normalize();
  if (joint.type == JointType::continuous) {
    joint.lower = -std::numbers::pi;
    joint.upper = std::numbers::pi;
  }
  return joint;
}

Robot::Parts reordered(Robot::Parts parts, int root, const std::vector<int>& order) {
  std::vector<Link> links = std::exchange(parts.links, {});
  std::vector<Joint> joints = std::exchange(parts.joints, {});
  std::vector<int> new_link(links.size(), 0);
  std::vector<int> new_joint(joints.size(), 0);
  parts.links.push_back(std::move(links[as_index(root)]));
  for (const int old_joint : order) {
    Joint joint = canonical(std::move(joints[as_index(old_joint)]));
    const int link = static_cast<int>(parts.links.size());
    new_link[as_index(joint.child_link)] = link;
    parts.links.push_back(std::move(links[as_index(joint.child_link)]));
    parts.links.back().parent_joint = link - 1;
    joint.parent_link = new_link[as_index(joint.parent_link)];
    joint.child_link = link;
    new_joint[as_index(old_joint)] = link - 1;
    parts.joints.push_back(std::move(joint));
  }
  for (Joint& joint : parts.joints) {
    if (joint.mimic) joint.mimic->joint = new_joint[as_index(joint.mimic->joint)];
  }
  return parts;
}

}  // namespace

tl::expected<Robot::Parts, PartsFault> sort_tree(Robot::Parts parts) {
  if (auto fault = check_values(parts)) return tl::unexpected(*fault);
  if (auto fault = fold_followers(parts)) return tl::unexpected(*fault);
  if (auto fault = assign_parents(parts)) return tl::unexpected(*fault);
  const auto root = find_root(parts);
  if (!root) return tl::unexpected(root.error());
  const std::vector<int> order = joints_in_order(parts, *root);
  if (order.size() == parts.joints.size()) return reordered(std::move(parts), *root, order);
  std::vector<bool> is_reached(parts.joints.size(), false);
  for (const int joint : order) is_reached[as_index(joint)] = true;
  int lost = 0;
  while (is_reached[as_index(lost)]) ++lost;
  return tl::unexpected(describe_loop(parts, parts.joints[as_index(lost)].child_link));
}

}  // namespace mneme::internal
