// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <limits>

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

// Alternating projections (Cheney and Goldstein, DOI 10.2307/2033416) are projected gradient steps
// on half the squared distance; where solids meet at a slant they creep. Momentum mends that (Beck
// and Teboulle, DOI 10.1137/080716542), restarted when it leads astray (O'Donoghue and Candes,
// DOI 10.1007/s10208-013-9150-3); only a round without momentum says that no way is left.
double distance(const Shape& a, const Shape& b) {
  constexpr int kMostRounds = 200;
  constexpr double kTolerance = 1e-6;
  Vec3 p = bounding_sphere(a).center;
  Vec3 from = p;
  double least = std::numeric_limits<double>::infinity();
  int momentum = 0;
  for (int round = 0; round < kMostRounds; ++round) {
    const Vec3 q = nearest_point(from, b);
    const Vec3 next = nearest_point(q, a);
    const double now = (next - q).norm();
    if (now < kTolerance) return 0;
    const bool has_settled = least - now < kTolerance;
    if (has_settled && momentum == 0) return std::min(now, least);
    const Vec3 step = next - p;
    if (now <= least) p = next;
    least = std::min(now, least);
    momentum = has_settled ? 0 : momentum + 1;
    from = p;
    if (momentum > 1) from += (momentum - 1.0) / (momentum + 2.0) * step;
  }
  return least;
}

}  // namespace mneme
