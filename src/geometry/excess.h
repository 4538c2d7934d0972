// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The shortest vector from a solid to a point, which every distance of this room is made of.
#pragma once

#include <algorithm>

#include <Eigen/Geometry>

#include "mneme/geometry.h"

namespace mneme::internal {

/// From a box around the origin to `p`: zero inside.
inline Vec3 excess_of_box(const Vec3& p, const Vec3& half_extents) {
  return p - p.cwiseMax(-half_extents).cwiseMin(half_extents);
}

/// From a cylinder around the origin, along z, to `p`: zero inside.
inline Vec3 excess_of_cylinder(const Vec3& p, double radius, double length) {
  const double r = p.head<2>().norm();
  const double beyond_side = r > radius ? (r - radius) / r : 0.0;
  const double z = p.z() - std::clamp(p.z(), -0.5 * length, 0.5 * length);
  return {beyond_side * p.x(), beyond_side * p.y(), z};
}

/// From the segment ab to `p`. Both ends are candidates, so that a segment too short for the
/// parameter of the nearest point to mean anything is treated as well as any other.
inline Vec3 excess_of_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0.0 ? std::clamp((p - a).dot(along) / length2, 0.0, 1.0) : 0.0;
  Vec3 nearest = p - a - t * along;
  for (const Vec3& end : {a, b}) {
    if ((p - end).squaredNorm() < nearest.squaredNorm()) {
      nearest = p - end;
    }
  }
  return nearest;
}

}  // namespace mneme::internal
