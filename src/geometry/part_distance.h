// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Exact distances from segments, boxes and the parts of a compound shape.
#pragma once

#include "mneme/geometry.h"

#include "geometry/parts.h"

#include <limits>

namespace mneme::internal {

/// From the segment ab to `p`.
[[nodiscard]] Vec3 excess_of_segment(const Vec3& p, const Vec3& a, const Vec3& b);
/// From a box around the origin to `p`: zero inside.
[[nodiscard]] Vec3 excess_of_box(const Vec3& p, const Vec3& half_extents);
/// Between the segment ab and a box around the origin.
[[nodiscard]] double distance_to_box(const Vec3& a, const Vec3& b, const Vec3& half_extents);

/// Squared sine of a triangle's corner up to which double precision does not tell its plane well:
/// its edges, which stand for it, miss it by no more than 5e-8 of their length.
inline constexpr double kLeastSine2 = 1e-14;

/// Across the triangle, (b - a) x (c - a); zero of a sliver, if the squared sine of the corner at a
/// is not above `least_sine2`, since rounding turns it anywhere.
[[nodiscard]] Vec3 normal_of(const Triangle& t, double least_sine2 = kLeastSine2);

/// The point of a part that is nearest to `p`: `p` itself inside a cube.
[[nodiscard]] Vec3 nearest_on(const Vec3& p, const CloudPoint& point);
[[nodiscard]] Vec3 nearest_on(const Vec3& p, const Triangle& triangle);
[[nodiscard]] Vec3 nearest_on(const Vec3& p, const Cube& cube);

/// Distance between the segment ab, which may be a point, and a part: 0 if they meet.
[[nodiscard]] double distance_between(const Vec3& a, const Vec3& b, const CloudPoint& point);
[[nodiscard]] double distance_between(const Vec3& a, const Vec3& b, const Triangle& triangle);
[[nodiscard]] double distance_between(const Vec3& a, const Vec3& b, const Cube& cube);

/// Distance between two triangles, exact if that is less than `limit`, and otherwise `limit`; 0 if
/// they meet.
[[nodiscard]] double distance_between(const Triangle& s, const Triangle& t, double limit);

/// The part that is nearest to the segment ab, in the frame of the parts and without their radius,
/// if it is closer than `limit`.
template <class Part>
[[nodiscard]] NearestPart nearest_part(const CompoundShape<Part>& compound, const Vec3& a,
                                       const Vec3& b,
                                       double limit = std::numeric_limits<double>::infinity()) {
  const std::vector<Part>& list = compound.parts->list();
  const auto distance_to = [&](int i) {
    return distance_between(a, b, list[static_cast<std::size_t>(i)]);
  };
  return PartsAccess::tree(*compound.parts)
      ->nearest({a.cwiseMin(b), a.cwiseMax(b)}, distance_to, limit);
}

}  // namespace mneme::internal
