// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "covering/touching.h"

#include <algorithm>

namespace mneme::internal {
namespace {

/// A sphere about the middle of the shapes' bounding box.
Sphere bound(std::span<const Capsule> shapes) {
  if (shapes.empty()) return {};
  Vec3 low = shapes.front().a;
  Vec3 high = low;
  for (const Capsule& shape : shapes) {
    low = low.cwiseMin(shape.a).cwiseMin(shape.b);
    high = high.cwiseMax(shape.a).cwiseMax(shape.b);
  }
  Sphere sphere{0.5 * (low + high), 0};
  for (const Capsule& shape : shapes) {
    const double farthest =
        std::max((shape.a - sphere.center).norm(), (shape.b - sphere.center).norm());
    sphere.radius = std::max(sphere.radius, farthest + shape.radius);
  }
  return sphere;
}

bool are_overlapping(const Sphere& s, const Sphere& t) {
  const double reach = s.radius + t.radius;
  return (s.center - t.center).squaredNorm() <= reach * reach;
}

bool are_overlapping(const Capsule& s, const Capsule& t) {
  if (s.a == s.b && t.a == t.b) return are_overlapping(Sphere{s.a, s.radius}, {t.a, t.radius});
  return segment_distance(s.a, s.b, t.a, t.b) <= s.radius + t.radius;
}

}  // namespace

PosedShapes::PosedShapes(const Robot& robot) : robot_(&robot) {
  for (const Link& link : robot.links()) {
    Body body;
    body.shapes = link.capsules;
    for (const Sphere& s : link.spheres) body.shapes.push_back({s.center, s.center, s.radius});
    body.bound = bound(body.shapes);
    local_.push_back(std::move(body));
  }
  posed_ = local_;
}

void PosedShapes::pose(std::span<const double> q) {
  const std::vector<Transform> poses = robot_->link_poses(q);
  for (std::size_t i = 0; i < local_.size(); ++i) {
    posed_[i].bound.center = poses[i] * local_[i].bound.center;
    for (std::size_t j = 0; j < local_[i].shapes.size(); ++j) {
      const Capsule& shape = local_[i].shapes[j];
      posed_[i].shapes[j].a = poses[i] * shape.a;
      posed_[i].shapes[j].b = poses[i] * shape.b;
    }
  }
}

bool PosedShapes::touch(int first, int second) const {
  const Body& s = posed_[static_cast<std::size_t>(first)];
  const Body& t = posed_[static_cast<std::size_t>(second)];
  if (s.shapes.empty() || t.shapes.empty() || !are_overlapping(s.bound, t.bound)) return false;
  return std::ranges::any_of(s.shapes, [&](const Capsule& shape) {
    return std::ranges::any_of(t.shapes,
                               [&](const Capsule& other) { return are_overlapping(shape, other); });
  });
}

}  // namespace mneme::internal
