// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// An arm in space whose first two joints lift and turn all the rest of it, and what they do to a
/// scene.
#pragma once

#include "support/support.h"

namespace mneme::test {

/// Hangs a link by a joint on the link `parent`.
inline void hang_link(Robot::Parts& parts, int parent, const Joint& like,
                      const std::vector<Sphere>& spheres, const std::vector<Capsule>& capsules) {
  const int child = static_cast<int>(parts.links.size());
  Link link;
  link.name = "link_" + std::to_string(child);
  link.spheres = spheres;
  link.capsules = capsules;
  Joint joint = like;
  joint.name = "joint_" + std::to_string(child);
  joint.parent_link = parent;
  joint.child_link = child;
  parts.links.push_back(link);
  parts.joints.push_back(joint);
}

inline Joint joint_at(JointType type, const Vec3& offset, const Vec3& axis, double lower,
                      double upper) {
  Joint joint;
  joint.type = type;
  joint.origin.translation = offset;
  joint.axis = axis;
  joint.lower = lower;
  joint.upper = upper;
  return joint;
}

inline Robot robot_of(const Robot::Parts& parts, const RobotOptions& options = {}) {
  return require(make_robot(parts, options));
}

inline constexpr double kLiftMost = 0.5, kTurnMost = 2.5;
/// Where the axis of the turning joint of lifting_arm() stands.
inline Vec3 turning_axis() { return {0.25, -0.1, 0}; }

/// A lift, a turn about an axis off the origin, a shoulder and an elbow, in this order. Links: base
/// 0, torso 1, column 2, upper arm 3, forearm 4 and a head 5 that is fixed to the torso.
inline Robot::Parts lifting_arm_parts() {
  Robot::Parts parts;
  parts.name = "lifting_arm";
  Link base;
  base.name = "base";
  base.spheres = {{Vec3(0, 0, 0.1), 0.2}};
  parts.links.push_back(base);
  const Vec3 torso(-0.1, 0.05, 0.4);
  hang_link(parts, 0, joint_at(JointType::prismatic, torso, Vec3::UnitZ(), 0, kLiftMost),
            {{Vec3::Zero(), 0.1}}, {});
  hang_link(parts, 1,
            joint_at(JointType::revolute, turning_axis() - Vec3(torso.x(), torso.y(), -0.2),
                     Vec3::UnitZ(), -kTurnMost, kTurnMost),
            {{Vec3(0.05, 0, 0), 0.06}}, {});
  hang_link(parts, 2, joint_at(JointType::revolute, Vec3(0.1, 0, 0.06), Vec3::UnitY(), -1.2, 1.5),
            {}, {{Vec3(0.08, 0, 0), Vec3(0.4, 0, 0), 0.04}});
  hang_link(parts, 3, joint_at(JointType::revolute, Vec3(0.45, 0, 0), Vec3::UnitY(), -2, 2),
            {{Vec3(0.45, 0.05, 0), 0.04}}, {{Vec3(0.08, 0, 0), Vec3(0.4, 0, 0), 0.03}});
  hang_link(parts, 1, joint_at(JointType::fixed, Vec3(0, 0, 0.5), Vec3::UnitX(), 0, 0),
            {{Vec3::Zero(), 0.08}}, {});
  return parts;
}
inline Robot lifting_arm() { return robot_of(lifting_arm_parts()); }

/// The transform of points by `motion`, without its mirror image.
inline Transform transform_of(const SymmetricJoints& joints, const Symmetry& motion) {
  const Eigen::Matrix3d turn = rotation_about(Vec3::UnitZ(), motion.rotation);
  const Vec3 axis(joints.axis_x, joints.axis_y, 0);
  return {turn, axis - turn * axis + Vec3(0, 0, motion.lift)};
}

inline Obstacle moved_obstacle(const Transform& motion, const Obstacle& obstacle) {
  Obstacle moved{obstacle.name, {}};
  for (const Shape& shape : obstacle.shapes) moved.shapes.push_back(transformed(motion, shape));
  return moved;
}

inline Scene moved_scene(const Transform& motion, const Scene& scene) {
  Scene moved{scene.name, {}};
  for (const Obstacle& obstacle : scene.obstacles) {
    moved.obstacles.push_back(moved_obstacle(motion, obstacle));
  }
  return moved;
}

inline Box box_at(const Vec3& center, const Vec3& half_extents) {
  return {{Eigen::Matrix3d::Identity(), center}, half_extents};
}

/// A board with a post on it, and a bar over them: three pairs within the reach of lifting_arm().
inline Scene shelf_scene() {
  return {"shelf",
          {{"board", {box_at({0.85, -0.1, 0.5}, {0.15, 0.3, 0.02})}},
           {"post", {Cylinder{{Eigen::Matrix3d::Identity(), {0.8, 0.05, 0.62}}, 0.03, 0.2}}},
           {"bar", {Capsule{{0.85, -0.4, 0.76}, {0.85, 0.2, 0.76}, 0.03}}}}};
}

}  // namespace mneme::test
