// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/trace.h"
#include "base/as_index.h"

#include <algorithm>

namespace mneme::internal {
namespace {

/// Points beyond this fraction of the largest distance are part of the tip.
constexpr double kTipFraction = 0.9;

/// Per link: true if `root` is the link or one of its ancestors.
std::vector<bool> carried_by(const Robot& robot, std::size_t root) {
  std::vector<bool> is_carried(robot.links().size(), false);
  is_carried[root] = true;
  for (const Joint& joint : robot.joints()) {
    if (is_carried[as_index(joint.parent_link)]) is_carried[as_index(joint.child_link)] = true;
  }
  return is_carried;
}

void append_points(const Link& link, const Transform& X_TL, std::vector<Vec3>& points) {
  for (const Sphere& sphere : link.spheres) points.push_back(X_TL * sphere.center);
  for (const Capsule& capsule : link.capsules) {
    points.push_back(X_TL * capsule.a);
    points.push_back(X_TL * capsule.b);
  }
}

Vec3 middle_of_farthest(const std::vector<Vec3>& points) {
  double reach = 0;
  for (const Vec3& point : points) reach = std::max(reach, point.norm());
  Vec3 sum = Vec3::Zero();
  int count = 0;
  for (const Vec3& point : points) {
    if (point.norm() < kTipFraction * reach) continue;
    sum += point;
    ++count;
  }
  return count == 0 ? sum : Vec3(sum / count);
}

}  // namespace

Skeleton::Skeleton(const Robot& robot) : robot_(robot) {
  if (robot.joint_count() == 0) return;
  tip_link_ = as_index(robot.group_joint(robot.joint_count() - 1).child_link);
  const std::vector<bool> is_carried = carried_by(robot, tip_link_);
  const std::vector<Transform> poses =
      robot.link_poses(Configuration(as_index(robot.joint_count()), 0.0));
  const Transform X_TW = poses[tip_link_].inverse();
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (is_carried[i]) append_points(robot.links()[i], X_TW * poses[i], points);
  }
  tip_in_link_ = middle_of_farthest(points);
}

Vec3 Skeleton::tip(std::span<const Transform> poses) const {
  return poses[tip_link_] * tip_in_link_;
}

std::vector<Vec3> Skeleton::points(std::span<const double> q) const {
  const std::vector<Transform> poses = robot_.link_poses(q);
  std::vector<Vec3> points;
  for (int i = 0; i < robot_.joint_count(); ++i) {
    points.push_back(poses[as_index(robot_.group_joint(i).child_link)].translation);
  }
  points.push_back(tip(poses));
  return points;
}

}  // namespace mneme::internal
