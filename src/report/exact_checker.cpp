// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/exact_checker.h"

#include <algorithm>

namespace mneme::internal {
namespace {

bool are_apart(const Vec3& a, double radius_a, const Vec3& b, double radius_b) {
  const double reach = radius_a + radius_b;
  return (a - b).squaredNorm() > reach * reach;
}

std::vector<Capsule> shapes_of(const Link& link) {
  std::vector<Capsule> shapes = link.capsules;
  for (const Sphere& sphere : link.spheres) {
    shapes.push_back({sphere.center, sphere.center, sphere.radius});
  }
  return shapes;
}

/// A sphere about the middle of the box that holds both ends of all shapes.
Sphere bound_of(const std::vector<Capsule>& shapes) {
  if (shapes.empty()) return {};
  Vec3 least = shapes.front().a;
  Vec3 most = least;
  for (const Capsule& shape : shapes) {
    least = least.cwiseMin(shape.a).cwiseMin(shape.b);
    most = most.cwiseMax(shape.a).cwiseMax(shape.b);
  }
  Sphere bound{0.5 * (least + most), 0};
  for (const Capsule& shape : shapes) {
    const double reach = std::max((shape.a - bound.center).norm(), (shape.b - bound.center).norm());
    bound.radius = std::max(bound.radius, reach + shape.radius);
  }
  return bound;
}

double distance_to(const Vec3& a, const Vec3& b, const Shape& shape) {
  return a == b ? distance(a, shape) : distance_to_segment(a, b, shape);
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
  const Vec3 center = X_WL * link_bounds_[link].center;
  for (std::size_t i = 0; i < scene_.obstacles.size(); ++i) {
    for (std::size_t j = 0; j < shape_bounds_[i].size(); ++j) {
      const Sphere& bound = shape_bounds_[i][j];
      if (are_apart(center, link_bounds_[link].radius, bound.center, bound.radius)) continue;
      for (const Capsule& own : links_[link]) {
        const Vec3 a = X_WL * own.a;
        const Vec3 b = own.a == own.b ? a : X_WL * own.b;
        if (distance_to(a, b, scene_.obstacles[i].shapes[j]) < own.radius) return true;
      }
    }
  }
  return false;
}

bool ExactChecker::touch(std::size_t a, const Transform& X_WA, std::size_t b,
                         const Transform& X_WB) const {
  const Sphere& bound_a = link_bounds_[a];
  const Sphere& bound_b = link_bounds_[b];
  if (are_apart(X_WA * bound_a.center, bound_a.radius, X_WB * bound_b.center, bound_b.radius)) {
    return false;
  }
  for (const Capsule& first : links_[a]) {
    const Vec3 p = X_WA * first.a;
    const Vec3 q = X_WA * first.b;
    for (const Capsule& second : links_[b]) {
      const double gap = segment_distance(p, q, X_WB * second.a, X_WB * second.b);
      if (gap < first.radius + second.radius) return true;
    }
  }
  return false;
}

}  // namespace mneme::internal
