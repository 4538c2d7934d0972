// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "cell/blocked_link.h"

#include "base/as_index.h"
#include "check/parted_pairs.h"
#include "geometry/solids.h"
#include "robot/kinematics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace mneme::internal {
namespace {

/// Contacts that are less deep than this do not count as proven, metres.
constexpr double kLeastDepth = 1e-4;

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

/// How deep a shape contains a capsule's axis, at least; 0 outside.
double depth_in(const Capsule& capsule, const Shape& shape) {
  double inside = 0;
  for (const Vec3& point : {capsule.a, capsule.b, Vec3((capsule.a + capsule.b) / 2)}) {
    const auto depth = [&](const auto& solid) { return depth_in(point, solid); };
    inside = std::max(inside, std::visit(depth, shape));
  }
  return inside;
}

/// A ball around a shape; infinite for compound shapes.
Sphere ball_around(const Shape& shape) {
  if (is_compound(shape)) return {Vec3::Zero(), std::numeric_limits<double>::infinity()};
  return bounding_sphere(shape);
}

}  // namespace

BlockedLink::BlockedLink(const CellRegion& region, const TaskFrame& frame)
    : frame_(frame), scene_(region.problem.scene.obstacles) {
  const Robot& robot = region.problem.robot;
  const int own = *robot.find_link(region.middle().link);
  const std::vector<Transform> poses = robot.link_poses(region.starts.front().q);
  const Transform X_LW = poses[as_index(own)].inverse();
  for (const int i : rigid_with(robot, own)) {
    const Link& link = robot.links()[as_index(i)];
    for (const Capsule& capsule : shapes_of(link, X_LW * poses[as_index(i)])) {
      Part part{capsule, 0, link.name, {}};
      part.away = std::max((capsule.a - region.pivot).norm(), (capsule.b - region.pivot).norm());
      for (const Obstacle& obstacle : scene_) {
        if (std::ranges::count(obstacle.may_touch, link.name) > 0) continue;
        for (const Shape& shape : obstacle.shapes) {
          const auto [center, radius] = ball_around(shape);
          part.obstacles.push_back({&shape, center, radius, &obstacle.name});
        }
      }
      parts_.push_back(std::move(part));
    }
  }
}

BlockedLink::Vicinity BlockedLink::look_around(const TaskBox& box, double margin) const {
  Vicinity result;
  const Transform pose = frame_.pose(box.center);
  for (const Part& part : parts_) {
    const Capsule placed = mneme::internal::moved(part.capsule, pose);
    const Vec3 middle = (placed.a + placed.b) / 2;
    const double moved = frame_.displacement(box, part.away);
    const double reach = placed.radius + moved + margin, half = (placed.b - placed.a).norm() / 2;
    for (const Place& place : part.obstacles) {
      const double apart = half + reach + place.radius;
      if ((middle - place.center).squaredNorm() > apart * apart) continue;
      const double outside = distance_to_segment(placed.a, placed.b, *place.shape);
      if (outside > reach) continue;
      if (std::isfinite(place.radius)) result.near.emplace_back(&part, &place);
      if (placed.radius - outside + depth_in(placed, *place.shape) <= moved + kLeastDepth) continue;
      result.blocked = BlockedBy{part.link, *place.obstacle};
      return result;
    }
  }
  return result;
}

std::optional<BlockedBy> BlockedLink::find(const Vicinity& vicinity, const CellTask& task,
                                           double margin) const {
  if (vicinity.near.empty()) return std::nullopt;
  const Transform pose = frame_.pose(task);
  for (const auto& [part, place] : vicinity.near) {
    const Capsule placed = mneme::internal::moved(part->capsule, pose);
    if (distance_to_segment(placed.a, placed.b, *place->shape) < placed.radius + margin) {
      return BlockedBy{part->link, *place->obstacle};
    }
  }
  return std::nullopt;
}

}  // namespace mneme::internal
