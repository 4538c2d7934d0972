// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/clearance.h"

#include <algorithm>
#include <limits>

namespace mneme::internal {
namespace {

/// True per link if a joint of the group stands above it.
std::vector<bool> moved_links(const Robot& robot) {
  std::vector<bool> is_moved(robot.links().size(), false);
  const std::span<const int> group = robot.group();
  for (std::size_t i = 0; i < robot.joints().size(); ++i) {
    const Joint& joint = robot.joints()[i];
    const auto is_in_group = [&](int index) { return std::ranges::count(group, index) > 0; };
    const bool is_driven =
        is_in_group(static_cast<int>(i)) || (joint.mimic && is_in_group(joint.mimic->joint));
    is_moved[static_cast<std::size_t>(joint.child_link)] =
        is_driven || is_moved[static_cast<std::size_t>(joint.parent_link)];
  }
  return is_moved;
}

}  // namespace

ClearanceMeter::ClearanceMeter(const Robot& robot, const Scene& scene) {
  const std::vector<bool> is_moved = moved_links(robot);
  for (std::size_t i = 0; i < robot.links().size(); ++i) {
    if (!is_moved[i]) continue;
    const Link& link = robot.links()[i];
    for (const Sphere& sphere : link.spheres) {
      bodies_.push_back({static_cast<int>(i), {sphere.center, sphere.center, sphere.radius}});
    }
    for (const Capsule& capsule : link.capsules) bodies_.push_back({static_cast<int>(i), capsule});
  }
  for (std::size_t i = 0; i < scene.obstacles.size(); ++i) {
    for (const Shape& shape : scene.obstacles[i].shapes) {
      parts_.push_back({static_cast<int>(i), &shape, bounding_sphere(shape)});
    }
  }
}

Clearance ClearanceMeter::measure(std::span<const Transform> poses) const {
  Clearance nearest{std::numeric_limits<double>::infinity(), -1, -1};
  for (const Body& body : bodies_) {
    const Transform& pose = poses[static_cast<std::size_t>(body.link)];
    const Vec3 a = pose * body.shape.a;
    const Vec3 b = pose * body.shape.b;
    const Vec3 middle = 0.5 * (a + b);
    const double reach = 0.5 * (b - a).norm() + body.shape.radius;
    for (const Part& part : parts_) {
      const double apart = (middle - part.bound.center).norm() - reach - part.bound.radius;
      if (apart >= nearest.distance) continue;
      const bool is_sphere = body.shape.a == body.shape.b;
      const double between =
          is_sphere ? distance(a, *part.shape) : distance_to_segment(a, b, *part.shape);
      const double gap = between - body.shape.radius;
      if (gap < nearest.distance) nearest = {gap, body.link, part.obstacle};
    }
  }
  return nearest;
}

}  // namespace mneme::internal
