// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/nearest_point.h"

#include "geometry/excess.h"

namespace mneme::internal {

Vec3 nearest_point(const Vec3& p, const Shape& shape) {
  if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    const Vec3 out = p - sphere->center;
    const double length = out.norm();
    return length <= sphere->radius ? p : Vec3(sphere->center + sphere->radius / length * out);
  }
  if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    const Vec3 out = excess_of_segment(p, capsule->a, capsule->b);
    const double length = out.norm();
    return length <= capsule->radius ? p : Vec3(p - (1 - capsule->radius / length) * out);
  }
  if (const auto* box = std::get_if<Box>(&shape)) {
    const Vec3 local = box->pose.inverse() * p;
    return p - box->pose.rotation * excess_of_box(local, box->half_extents);
  }
  const auto& cylinder = std::get<Cylinder>(shape);
  const Vec3 local = cylinder.pose.inverse() * p;
  return p - cylinder.pose.rotation * excess_of_cylinder(local, cylinder.radius, cylinder.length);
}

}  // namespace mneme::internal
