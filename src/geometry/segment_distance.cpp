// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/geometry.h"

#include "geometry/excess.h"

namespace mneme {

double segment_distance(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = b - a;
  const Vec3 v = d - c;
  // Wherever rounding puts them, candidates are distances between points of the segments, so that
  // none is less than the truth. The ends are exact where the segments are parallel, the crossing
  // where they are not.
  double least = std::min(
      {internal::excess_of_segment(a, c, d).norm(), internal::excess_of_segment(b, c, d).norm(),
       internal::excess_of_segment(c, a, b).norm(), internal::excess_of_segment(d, a, b).norm()});
  const Vec3 normal = u.cross(v);
  const double determinant = normal.squaredNorm();
  if (determinant > 0.0) {
    const double s = std::clamp((c - a).cross(v).dot(normal) / determinant, 0.0, 1.0);
    least = std::min(least, internal::excess_of_segment(a + s * u, c, d).norm());
  }
  return least;
}

}  // namespace mneme
