// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/memory.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace mneme {
namespace {

double wrapped(double angle) {
  constexpr double kTurn = 2 * std::numbers::pi;
  const double result = angle - kTurn * std::floor((angle + std::numbers::pi) / kTurn);
  // The subtraction may round up to pi, outside the half-open interval.
  return result < std::numbers::pi ? result : -std::numbers::pi;
}

constexpr double kAxisTolerance = 1e-6;

/// Walks from the root as long as one joint carries all further joints of the group.
class LeadingJoints {
 public:
  explicit LeadingJoints(const Robot& robot)
      : robot_(robot),
        poses_(
            robot.link_poses(Configuration(static_cast<std::size_t>(robot.joint_count()), 0.0))) {}

  SymmetricJoints find() {
    SymmetricJoints found;
    for (int index = next_after(0); index >= 0;) {
      const Joint& joint = robot_.group_joint(index);
      if (!take(index, joint, found)) break;
      index = next_after(joint.child_link);
    }
    return found;
  }

 private:
  /// The only joint of the group directly below `link`, or -1.
  int next_after(int link) const {
    int next = -1;
    for (int i = 0; i < robot_.joint_count(); ++i) {
      if (!is_first_below(link, robot_.group_joint(i))) continue;
      if (next >= 0) return -1;
      next = i;
    }
    return next;
  }

  bool is_first_below(int link, const Joint& joint) const {
    int ancestor = joint.parent_link;
    while (ancestor != link) {
      const int parent = robot_.links()[static_cast<std::size_t>(ancestor)].parent_joint;
      if (parent < 0 || is_in_group(parent)) return false;
      ancestor = robot_.joints()[static_cast<std::size_t>(parent)].parent_link;
    }
    return true;
  }

  bool is_in_group(int joint) const { return std::ranges::count(robot_.group(), joint) > 0; }

  /// True if another joint mimics this one: then the links it carries do not move rigidly.
  bool is_followed(int joint) const {
    return std::ranges::any_of(robot_.joints(), [&](const Joint& other) {
      return other.mimic && other.mimic->joint == joint;
    });
  }

  /// Records the joint if it is a symmetry; one prismatic and one turning joint at most.
  bool take(int index, const Joint& joint, SymmetricJoints& found) const {
    if (is_followed(robot_.group()[static_cast<std::size_t>(index)])) return false;
    const Transform& pose = poses_[static_cast<std::size_t>(joint.child_link)];
    const Vec3 axis = pose.rotation * joint.axis;
    // Only +z: a joint about or along -z would need the opposite sign.
    if (axis.z() < 1 - kAxisTolerance) return false;
    if (joint.type == JointType::prismatic) {
      if (found.lift >= 0) return false;
      found.lift = index;
      return true;
    }
    if (found.turn >= 0) return false;
    found.turn = index;
    found.axis_x = pose.translation.x();
    found.axis_y = pose.translation.y();
    return true;
  }

  const Robot& robot_;
  std::vector<Transform> poses_;
};

}  // namespace

Symmetry inverse(const Symmetry& motion) {
  // A mirror image followed by a rotation is a reflection, its own inverse.
  const double rotation = motion.is_mirrored ? motion.rotation : wrapped(-motion.rotation);
  return {rotation, motion.is_mirrored, -motion.lift};
}

Symmetry compose(const Symmetry& second, const Symmetry& first) {
  const double first_rotation = second.is_mirrored ? -first.rotation : first.rotation;
  return {wrapped(second.rotation + first_rotation), second.is_mirrored != first.is_mirrored,
          second.lift + first.lift};
}

Configuration moved_configuration(const SymmetricJoints& joints, const Symmetry& motion,
                                  std::span<const double> q) {
  Configuration result(q.begin(), q.end());
  if (motion.is_mirrored) {
    for (double& value : result) value = -value;
  }
  if (joints.turn >= 0) {
    double& turn = result[static_cast<std::size_t>(joints.turn)];
    turn = wrapped(turn + motion.rotation);
  }
  if (joints.lift >= 0) result[static_cast<std::size_t>(joints.lift)] += motion.lift;
  return result;
}

PrimitiveKey moved_key(const Symmetry& motion, const PrimitiveKey& key) {
  assert(key.size() % 3 == 0);
  const double cosine = std::cos(motion.rotation);
  const double sine = std::sin(motion.rotation);
  PrimitiveKey result = key;
  for (std::size_t i = 0; i + 2 < key.size(); i += 3) {
    const double x = key[i];
    const double y = motion.is_mirrored ? -key[i + 1] : key[i + 1];
    result[i] = cosine * x - sine * y;
    result[i + 1] = sine * x + cosine * y;
  }
  return result;
}

SymmetricJoints find_symmetric_joints(const Robot& robot) { return LeadingJoints(robot).find(); }

}  // namespace mneme
