// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "cell/blocked_link.h"

#include "base/as_index.h"
#include "robot/kinematics.h"

#include <algorithm>

namespace mneme::internal {
namespace {

/// Contacts that are less deep than this do not count as proven, metres.
constexpr double kLeastDepth = 1e-4;

/// True if only fixed joints are between the links.
bool is_rigid(const Robot& robot, int from, int to) {
  const auto group = robot.group();
  const auto root_of = [&](int link) {
    const std::vector<bool> is_moving = find_moving(robot.joints(), group);
    while (robot.links()[as_index(link)].parent_joint >= 0) {
      const int joint = robot.links()[as_index(link)].parent_joint;
      if (is_moving[as_index(joint)]) break;
      link = robot.joints()[as_index(joint)].parent_link;
    }
    return link;
  };
  return root_of(from) == root_of(to);
}

/// How deep a box contains a point, at least; 0 for other shapes and points outside.
double depth_in(const Vec3& point, const Shape& shape) {
  const auto* box = std::get_if<Box>(&shape);
  if (box == nullptr) return 0;
  const Vec3 inside = box->half_extents - (box->pose.inverse() * point).cwiseAbs();
  return std::max(0.0, inside.minCoeff());
}

/// How far a capsule may move without leaving a shape; negative if it may be free.
double depth_in(const Capsule& capsule, const Shape& shape) {
  const double outside = distance_to_segment(capsule.a, capsule.b, shape);
  const double inside = std::max(depth_in(capsule.a, shape), depth_in(capsule.b, shape));
  return capsule.radius - outside + inside;
}

}  // namespace

BlockedLink::BlockedLink(const CellRegion& region, const TaskFrame& frame)
    : frame_(frame), scene_(region.problem.scene.obstacles) {
  const Robot& robot = region.problem.robot;
  const int own = *robot.find_link(region.middle().link);
  const std::vector<Transform> poses = robot.link_poses(region.starts.front().q);
  const Transform X_LW = poses[as_index(own)].inverse();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!is_rigid(robot, own, static_cast<int>(i))) continue;
    const Link& link = robot.links()[i];
    for (const Capsule& capsule : shapes_of(link, X_LW * poses[i])) {
      Part part{capsule, 0, link.name, {}};
      part.away = std::max((capsule.a - region.pivot).norm(), (capsule.b - region.pivot).norm());
      for (const Obstacle& obstacle : scene_) {
        if (std::ranges::count(obstacle.may_touch, link.name) == 0) {
          part.obstacles.push_back(&obstacle);
        }
      }
      parts_.push_back(std::move(part));
    }
  }
}

std::optional<BlockedBy> BlockedLink::find(const TaskBox& box) const {
  const Transform pose = frame_.pose(box.center);
  for (const Part& part : parts_) {
    const double moved = frame_.displacement(box, part.away) + kLeastDepth;
    const Capsule placed = mneme::internal::moved(part.capsule, pose);
    for (const Obstacle* obstacle : part.obstacles) {
      for (const Shape& shape : obstacle->shapes) {
        if (depth_in(placed, shape) > moved) return BlockedBy{part.link, obstacle->name};
      }
    }
  }
  return std::nullopt;
}

}  // namespace mneme::internal
