// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "cell/blocked_link.h"

#include "base/as_index.h"
#include "robot/kinematics.h"

#include <algorithm>
#include <cmath>
#include <utility>

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

// How deep a shape contains a point, at least; negative outside.

double depth_in(const Vec3& point, const Sphere& s) { return s.radius - (point - s.center).norm(); }
double depth_in(const Vec3& point, const Capsule& c) {
  return c.radius - segment_distance(point, point, c.a, c.b);
}
double depth_in(const Vec3& point, const Box& box) {
  return (box.half_extents - (box.pose.inverse() * point).cwiseAbs()).minCoeff();
}
double depth_in(const Vec3& point, const Cylinder& c) {
  const Vec3 p = c.pose.inverse() * point;
  return std::min(c.radius - p.head<2>().norm(), c.length / 2 - std::abs(p.z()));
}
template <class Part>
double depth_in(const Vec3&, const CompoundShape<Part>&) {
  return 0;
}

/// How far a capsule may move without leaving a shape; negative if it may be free.
double depth_in(const Capsule& capsule, const Shape& shape) {
  double inside = 0;
  for (const Vec3& point : {capsule.a, capsule.b, Vec3((capsule.a + capsule.b) / 2)}) {
    const auto depth = [&](const auto& solid) { return depth_in(point, solid); };
    inside = std::max(inside, std::visit(depth, shape));
  }
  return capsule.radius - distance_to_segment(capsule.a, capsule.b, shape) + inside;
}

/// Radius of a ball about the shape's middle; negative for compound shapes.
std::pair<Vec3, double> ball_around(const Shape& shape) {
  if (const auto* s = std::get_if<Sphere>(&shape)) return {s->center, s->radius};
  if (const auto* c = std::get_if<Capsule>(&shape)) {
    return {(c->a + c->b) / 2, (c->b - c->a).norm() / 2 + c->radius};
  }
  if (const auto* b = std::get_if<Box>(&shape)) {
    return {b->pose.translation, b->half_extents.norm()};
  }
  if (const auto* c = std::get_if<Cylinder>(&shape)) {
    return {c->pose.translation, std::hypot(c->radius, c->length / 2)};
  }
  return {Vec3::Zero(), -1};
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
        if (std::ranges::count(obstacle.may_touch, link.name) > 0) continue;
        for (const Shape& shape : obstacle.shapes) {
          const auto [center, radius] = ball_around(shape);
          if (radius >= 0) part.obstacles.push_back({&shape, center, radius, &obstacle.name});
        }
      }
      parts_.push_back(std::move(part));
    }
  }
}

/// Calls `is_deep(part, depth)` with how far parts within `margin` of a shape may move without
/// leaving it.
template <class DepthOf>
std::optional<BlockedBy> BlockedLink::find_deep(const CellTask& task, double margin,
                                                const DepthOf& is_deep) const {
  const Transform pose = frame_.pose(task);
  for (const Part& part : parts_) {
    const Capsule placed = mneme::internal::moved(part.capsule, pose);
    const Vec3 middle = (placed.a + placed.b) / 2;
    const double reach = (placed.b - placed.a).norm() / 2 + placed.radius + margin;
    for (const Place& place : part.obstacles) {
      const double apart = reach + place.radius;
      if ((middle - place.center).squaredNorm() > apart * apart) continue;
      if (is_deep(part, depth_in(placed, *place.shape))) {
        return BlockedBy{part.link, *place.obstacle};
      }
    }
  }
  return std::nullopt;
}

std::optional<BlockedBy> BlockedLink::find(const TaskBox& box) const {
  return find_deep(box.center, 0, [&](const Part& part, double depth) {
    return depth > frame_.displacement(box, part.away) + kLeastDepth;
  });
}

std::optional<BlockedBy> BlockedLink::find(const CellTask& task, double margin) const {
  return find_deep(task, margin, [&](const Part&, double depth) { return depth > -margin; });
}

}  // namespace mneme::internal
