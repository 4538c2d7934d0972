// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/excess.h"

namespace mneme {
namespace {

/// The point of a solid that is nearest to `p`.
Vec3 nearest_point(const Vec3& p, const Shape& shape) {
  if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    const Vec3 out = p - sphere->center;
    const double length = out.norm();
    return length <= sphere->radius ? p : Vec3(sphere->center + sphere->radius / length * out);
  }
  if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    const Vec3 out = internal::excess_of_segment(p, capsule->a, capsule->b);
    const double length = out.norm();
    return length <= capsule->radius ? p : Vec3(p - (1 - capsule->radius / length) * out);
  }
  if (const auto* box = std::get_if<Box>(&shape)) {
    const Vec3 local = box->pose.inverse() * p;
    return p - box->pose.rotation * internal::excess_of_box(local, box->half_extents);
  }
  const auto& cylinder = std::get<Cylinder>(shape);
  const Vec3 local = cylinder.pose.inverse() * p;
  return p - cylinder.pose.rotation *
                 internal::excess_of_cylinder(local, cylinder.radius, cylinder.length);
}

}  // namespace

// Alternating projections (von Neumann; Cheney and Goldstein, DOI 10.2307/2033416): between convex
// sets they converge to a nearest pair.
double distance(const Shape& a, const Shape& b) {
  constexpr int kMostRounds = 200;
  constexpr double kTolerance = 1e-6;
  Vec3 p = bounding_sphere(a).center;
  double last = std::numeric_limits<double>::infinity();
  for (int round = 0; round < kMostRounds; ++round) {
    const Vec3 q = nearest_point(p, b);
    p = nearest_point(q, a);
    const double now = (p - q).norm();
    if (now < kTolerance) return 0;
    if (last - now < kTolerance) return now;
    last = now;
  }
  return last;
}

}  // namespace mneme
