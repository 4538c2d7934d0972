// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/robot_tree.h"
#include "base/as_index.h"
#include "robot/kinematics.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

namespace mneme::internal {
namespace {

constexpr int kVersion = 2;

/// Collects the bytes to hash, little-endian.
class Bytes {
 public:
  void add(std::uint64_t word) {
    for (int shift = 0; shift < 64; shift += 8) bytes_.push_back(static_cast<char>(word >> shift));
  }
  void add(int value) { add(static_cast<std::uint64_t>(value)); }
  void add(double value) {
    // The last bits of sin and cos differ between C libraries.
    const double rounded = std::abs(value) < 1e6 ? std::round(value * 1e9) : value * 1e9;
    add(std::bit_cast<std::uint64_t>(rounded == 0 ? 0.0 : rounded));
  }
  void add(const Vec3& v) {
    for (int i = 0; i < 3; ++i) add(v[i]);
  }
  void add_count(std::size_t count) { add(static_cast<std::uint64_t>(count)); }
  [[nodiscard]] std::uint64_t hash() const { return XXH3_64bits(bytes_.data(), bytes_.size()); }

 private:
  std::string bytes_;
};

void add_shapes(Bytes& bytes, const Link& link) {
  bytes.add_count(link.spheres.size());
  for (const Sphere& sphere : link.spheres) {
    bytes.add(sphere.center);
    bytes.add(sphere.radius);
  }
  bytes.add_count(link.capsules.size());
  for (const Capsule& capsule : link.capsules) {
    bytes.add(capsule.a);
    bytes.add(capsule.b);
    bytes.add(capsule.radius);
  }
}

void add_value(Bytes& bytes, const Joint& joint, bool is_in_group, bool is_moving) {
  bytes.add(static_cast<int>(is_moving));
  if (is_in_group) {
    bytes.add(joint.lower);
    bytes.add(joint.upper);
  } else if (is_moving) {
    bytes.add(joint.mimic->joint);
    bytes.add(joint.mimic->multiplier);
    bytes.add(joint.mimic->offset);
  } else {
    bytes.add(joint.fixed_value);
  }
}

void add_joint(Bytes& bytes, const Joint& joint, bool is_in_group, bool is_moving) {
  bytes.add(static_cast<int>(joint.type));
  bytes.add(joint.parent_link);
  bytes.add(joint.child_link);
  for (int i = 0; i < 3; ++i) bytes.add(Vec3(joint.origin.rotation.col(i)));
  bytes.add(joint.origin.translation);
  if (joint.type == JointType::fixed) return;
  bytes.add(joint.axis);
  add_value(bytes, joint, is_in_group, is_moving);
}

void add_pairs(Bytes& bytes, std::span<const std::pair<int, int>> pairs) {
  bytes.add_count(pairs.size());
  for (const auto& [first, second] : pairs) {
    bytes.add(first);
    bytes.add(second);
  }
}

}  // namespace

std::string hash_robot(std::span<const Link> links, std::span<const Joint> joints,
                       std::span<const int> group, std::span<const std::pair<int, int>> self_pairs,
                       std::span<const std::pair<int, int>> exact_pairs) {
  Bytes bytes;
  bytes.add(kVersion);
  bytes.add_count(links.size());
  for (const Link& link : links) add_shapes(bytes, link);
  const std::vector<bool> is_moving = find_moving(joints, group);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const bool is_in_group = std::ranges::find(group, static_cast<int>(i)) != group.end();
    add_joint(bytes, joints[i], is_in_group, is_moving[i]);
  }
  bytes.add_count(group.size());
  for (const int joint : group) bytes.add(joint);
  add_pairs(bytes, self_pairs);
  // Robots without them keep the hash under which experience was stored before there were any.
  if (!exact_pairs.empty()) add_pairs(bytes, exact_pairs);
  return fmt::format("{:016x}", bytes.hash());
}

namespace {

/// Joints of the group in its order, then followers that carry a joint of the group, in tree order.
std::vector<int> carrying_joints(std::span<const Joint> joints, std::span<const int> group) {
  const std::vector<bool> is_moving = find_moving(joints, group);
  std::vector<bool> is_above(joints.size() + 1, false);  // of each link
  std::vector<int> carrying(group.begin(), group.end());
  for (std::size_t i = joints.size(); i > 0; --i) {
    const Joint& joint = joints[i - 1];
    const int index = static_cast<int>(i - 1);
    const bool is_in_group = std::ranges::find(group, index) != group.end();
    const bool is_carrying = is_in_group || is_above[as_index(joint.child_link)];
    if (is_carrying) is_above[as_index(joint.parent_link)] = true;
    if (is_carrying && !is_in_group && is_moving[i - 1]) carrying.push_back(index);
  }
  std::sort(carrying.begin() + static_cast<std::ptrdiff_t>(group.size()), carrying.end());
  return carrying;
}

/// Pose of a link in the frame that the carrying joint `carrier` moves, or the root's (-1).
struct Mount {
  int carrier = -1;
  Transform pose;
};

void add_frame(Bytes& bytes, const Joint& joint, const Mount& mount,
               std::span<const int> carrying) {
  const auto number_of = [&](int index) {
    return static_cast<int>(std::ranges::find(carrying, index) - carrying.begin());
  };
  bytes.add(static_cast<int>(joint.type));
  bytes.add(mount.carrier);
  for (int i = 0; i < 3; ++i) bytes.add(Vec3(mount.pose.rotation.col(i)));
  bytes.add(mount.pose.translation);
  bytes.add(joint.axis);
  if (!joint.mimic) return;
  bytes.add(number_of(joint.mimic->joint));
  bytes.add(joint.mimic->multiplier);
  bytes.add(joint.mimic->offset);
}

}  // namespace

std::string hash_kinematics(std::span<const Joint> joints, std::span<const int> group) {
  const std::vector<int> carrying = carrying_joints(joints, group);
  std::vector<Mount> mounts(joints.size() + 1);
  std::vector<Mount> frames(carrying.size());
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const Joint& joint = joints[i];
    const Mount& parent = mounts[as_index(joint.parent_link)];
    const Mount mount{parent.carrier, parent.pose * joint.origin};
    const auto found = std::ranges::find(carrying, static_cast<int>(i));
    Mount& child = mounts[as_index(joint.child_link)];
    if (found == carrying.end()) {
      child = {mount.carrier, mount.pose * joint_motion(joint, joint.fixed_value)};
    } else {
      frames[as_index(found - carrying.begin())] = mount;
      child = {static_cast<int>(found - carrying.begin()), {}};
    }
  }
  Bytes of_frames, of_limits;
  for (std::size_t i = 0; i < carrying.size(); ++i) {
    add_frame(of_frames, joints[as_index(carrying[i])], frames[i], carrying);
  }
  for (const int joint : group) {
    of_limits.add(joints[as_index(joint)].lower);
    of_limits.add(joints[as_index(joint)].upper);
  }
  return fmt::format("{:08x}{:08x}", of_frames.hash() >> 32, of_limits.hash() >> 32);
}

}  // namespace mneme::internal
