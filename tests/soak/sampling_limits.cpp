// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "soak/sampling_limits.h"

#include <Eigen/Geometry>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace mneme::soak {
namespace {

std::vector<Sphere> ends_of(const Link& link) {
  std::vector<Sphere> ends = link.spheres;
  for (const Capsule& capsule : link.capsules) {
    ends.push_back({capsule.a, capsule.radius});
    ends.push_back({capsule.b, capsule.radius});
  }
  return ends;
}

/// True if the joint is between the root and the link.
bool carries(const Robot& robot, int joint, int link) {
  while (link > 0) {
    const int parent = robot.links()[static_cast<std::size_t>(link)].parent_joint;
    if (parent == joint) return true;
    link = robot.joints()[static_cast<std::size_t>(parent)].parent_link;
  }
  return false;
}

/// Squared metres per radian that `joint` moves the far side of a ball around `center`.
double squared_speed(const Joint& joint, const std::vector<Transform>& poses, const Vec3& center,
                     double radius) {
  if (joint.type == JointType::prismatic) return 1;
  const Transform& frame = poses[static_cast<std::size_t>(joint.child_link)];
  const Vec3 axis = frame.rotation * joint.axis;
  const double away = axis.cross(center - frame.translation).norm() + radius;
  return away * away;
}

}  // namespace

SamplingLimits measure_limits(const Robot& robot, int samples, Rng& rng) {
  SamplingLimits limits{0, std::numeric_limits<double>::infinity()};
  for (int sample = 0; sample < samples; ++sample) {
    Configuration q;
    for (int i = 0; i < robot.joint_count(); ++i) {
      q.push_back(rng.uniform(robot.group_joint(i).lower, robot.group_joint(i).upper));
    }
    const std::vector<Transform> poses = robot.link_poses(q);
    for (std::size_t link = 0; link < poses.size(); ++link) {
      for (const Sphere& end : ends_of(robot.links()[link])) {
        double squares = 0;
        for (const int joint : robot.group()) {
          if (!carries(robot, joint, static_cast<int>(link))) continue;
          squares += squared_speed(robot.joints()[static_cast<std::size_t>(joint)], poses,
                                   poses[link] * end.center, end.radius);
        }
        if (squares > 0) limits.thinnest = std::min(limits.thinnest, end.radius);
        limits.speed = std::max(limits.speed, std::sqrt(squares));
      }
    }
  }
  return limits;
}

double deepest_cut(double radius, double step) {
  if (step >= 2 * radius) return 2 * radius;
  return radius - std::sqrt(radius * radius - step * step / 4);
}

}  // namespace mneme::soak
