// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "check/exact_checker.h"

#include <algorithm>

#include "robot/link_shapes.h"

namespace mneme::internal {
namespace {

bool are_apart(const Sphere& a, const Sphere& b) {
  const double reach = a.radius + b.radius;
  return (a.center - b.center).squaredNorm() > reach * reach;
}

Sphere moved(const Sphere& sphere, const Transform& X_WL) {
  return {X_WL * sphere.center, sphere.radius};
}

Sphere bound_of(const Capsule& capsule) {
  if (capsule.a == capsule.b) return {capsule.a, capsule.radius};
  return {0.5 * (capsule.a + capsule.b), 0.5 * (capsule.b - capsule.a).norm() + capsule.radius};
}

}  // namespace

ExactChecker::ExactChecker(const Robot& robot, const Scene& scene) : robot_(robot), scene_(scene) {
  for (const Link& link : robot.links()) {
    links_.push_back(shapes_of(link));
    link_bounds_.push_back(bound_of(links_.back()));
  }
  for (const Obstacle& obstacle : scene.obstacles) {
    auto& bounds = shape_bounds_.emplace_back();
    for (const Shape& shape : obstacle.shapes) bounds.push_back(bounding_sphere(shape));
  }
}

bool ExactChecker::is_free(std::span<const double> q) const {
  const std::vector<Transform> poses = robot_.link_poses(q);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!links_[i].empty() && touches_obstacle(i, poses[i])) return false;
  }
  return std::ranges::none_of(robot_.self_pairs(), [&](const std::pair<int, int>& pair) {
    const auto a = static_cast<std::size_t>(pair.first);
    const auto b = static_cast<std::size_t>(pair.second);
    return touch(a, poses[a], b, poses[b]);
  });
}

bool ExactChecker::touches_obstacle(std::size_t link, const Transform& X_WL) const {
  const Sphere bound = moved(link_bounds_[link], X_WL);
  for (std::size_t i = 0; i < scene_.obstacles.size(); ++i) {
    for (std::size_t j = 0; j < shape_bounds_[i].size(); ++j) {
      const Sphere& other = shape_bounds_[i][j];
      if (are_apart(bound, other)) continue;
      for (const Capsule& own : links_[link]) {
        const Capsule posed = moved(own, X_WL);
        if (are_apart(bound_of(posed), other)) continue;
        if (distance_to_segment(posed.a, posed.b, scene_.obstacles[i].shapes[j]) < own.radius) {
          return true;
        }
      }
    }
  }
  return false;
}

bool ExactChecker::touch(std::size_t a, const Transform& X_WA, std::size_t b,
                         const Transform& X_WB) const {
  const Sphere bound = moved(link_bounds_[a], X_WA), other_bound = moved(link_bounds_[b], X_WB);
  if (are_apart(bound, other_bound)) return false;
  for (const Capsule& first : links_[a]) {
    const Capsule posed = moved(first, X_WA);
    if (are_apart(bound_of(posed), other_bound)) continue;
    for (const Capsule& second : links_[b]) {
      const Capsule other = moved(second, X_WB);
      if (are_apart(bound_of(posed), bound_of(other))) continue;
      if (segment_distance(posed.a, posed.b, other.a, other.b) < posed.radius + other.radius) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace mneme::internal
