// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "check/clearance.h"

#include <algorithm>
#include <limits>

#include "robot/link_shapes.h"

namespace mneme::internal {
ClearanceMeter::ClearanceMeter(const Robot& robot, const Scene& scene) {
  const std::vector<bool> is_moved = find_moving_links(robot);
  for (std::size_t i = 0; i < robot.links().size(); ++i) {
    if (!is_moved[i]) continue;
    for (const Capsule& shape : shapes_of(robot.links()[i])) {
      bodies_.push_back({static_cast<int>(i), shape});
    }
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
