// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "covering/touching.h"

#include <algorithm>
#include <utility>

#include "robot/link_shapes.h"

namespace mneme::internal {
namespace {

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
    std::vector<Capsule> shapes = shapes_of(link);
    const Sphere bound = bound_of(shapes);
    local_.push_back({bound, std::move(shapes)});
  }
  posed_ = local_;
}

void PosedShapes::pose(std::span<const double> q) {
  const std::vector<Transform> poses = robot_->link_poses(q);
  for (std::size_t i = 0; i < local_.size(); ++i) {
    posed_[i].bound.center = poses[i] * local_[i].bound.center;
    for (std::size_t j = 0; j < local_[i].shapes.size(); ++j) {
      posed_[i].shapes[j] = moved(local_[i].shapes[j], poses[i]);
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
