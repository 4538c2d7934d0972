// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/geometry.h"

#include "geometry/excess.h"

namespace mneme {
namespace {

struct FromPoint {
  const Vec3& p;
  double operator()(const Sphere& s) const {
    return std::max(0.0, (p - s.center).norm() - s.radius);
  }
  double operator()(const Box& s) const {
    return internal::excess_of_box(s.pose.inverse() * p, s.half_extents).norm();
  }
  double operator()(const Cylinder& s) const {
    return internal::excess_of_cylinder(s.pose.inverse() * p, s.radius, s.length).norm();
  }
  double operator()(const Capsule& s) const {
    return std::max(0.0, internal::excess_of_segment(p, s.a, s.b).norm() - s.radius);
  }
};

}  // namespace

double distance(const Vec3& point, const Shape& shape) {
  return std::visit(FromPoint{point}, shape);
}

}  // namespace mneme
