// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/kinematics.h"
#include "base/as_index.h"

#include <algorithm>
#include <cmath>

namespace mneme::internal {

namespace {

double farthest_slide(const Robot& robot, const Joint& joint) {
  if (joint.mimic) {
    const double followed = farthest_slide(robot, robot.joints()[as_index(joint.mimic->joint)]);
    return std::abs(joint.mimic->multiplier) * followed + std::abs(joint.mimic->offset);
  }
  return std::max({std::abs(joint.lower), std::abs(joint.upper), std::abs(joint.fixed_value)});
}

}  // namespace

bool has_shapes(const Link& link) { return !link.spheres.empty() || !link.capsules.empty(); }

std::vector<Capsule> shapes_of(const Link& link) { return shapes_of(link, {}); }

std::vector<Capsule> shapes_of(const Link& link, const Transform& X_WL) {
  std::vector<Capsule> shapes;
  shapes.reserve(link.spheres.size() + link.capsules.size());
  for (const Sphere& sphere : link.spheres) {
    shapes.push_back(moved({sphere.center, sphere.center, sphere.radius}, X_WL));
  }
  for (const Capsule& capsule : link.capsules) shapes.push_back(moved(capsule, X_WL));
  return shapes;
}

Capsule moved(const Capsule& capsule, const Transform& X_WL) {
  const Vec3 a = X_WL * capsule.a;
  return {a, capsule.a == capsule.b ? a : X_WL * capsule.b, capsule.radius};
}

Sphere bound_of(std::span<const Capsule> shapes) {
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

double farthest_reach(const Robot& robot) {
  double most = 0;
  for (int index = 0; index < std::ssize(robot.links()); ++index) {
    const Link& link = robot.links()[as_index(index)];
    if (!has_shapes(link)) continue;
    const Sphere bound = bound_of(shapes_of(link));
    double reach = bound.center.norm() + bound.radius;
    for (const int i : joints_to(robot, index)) {
      const Joint& joint = robot.joints()[as_index(i)];
      reach += joint.origin.translation.norm();
      if (joint.type == JointType::prismatic) reach += farthest_slide(robot, joint);
    }
    most = std::max(most, reach);
  }
  return most;
}

}  // namespace mneme::internal
