// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "spheres/surface_distance.h"

#include "base/as_index.h"
#include "base/threads.h"
#include "geometry/part_distance.h"

#include <cmath>

namespace mneme::internal {

SurfaceDistance::Facet::Facet(const Triangle& t)
    : triangle(t),
      ab(t.b - t.a),
      ac(t.c - t.a),
      normal(normal_of(t)),
      ab_ab(ab.squaredNorm()),
      ab_ac(ab.dot(ac)),
      ac_ac(ac.squaredNorm()),
      normal2(normal.squaredNorm()) {}

// By Ericson, Real-Time Collision Detection (2005), 5.1.5: the region of the triangle's corners,
// edges and face in which the point is.
double SurfaceDistance::Facet::squared_distance(const Vec3& p) const {
  if (normal2 == 0) return (p - nearest_on(p, triangle)).squaredNorm();
  const Vec3 from_a = p - triangle.a;
  const double a_b = ab.dot(from_a), a_c = ac.dot(from_a);
  if (a_b <= 0 && a_c <= 0) return from_a.squaredNorm();
  const double b_b = a_b - ab_ab, b_c = a_c - ab_ac;
  if (b_b >= 0 && b_c <= b_b) return (p - triangle.b).squaredNorm();
  const double c_b = a_b - ab_ac, c_c = a_c - ac_ac;
  if (c_c >= 0 && c_b <= c_c) return (p - triangle.c).squaredNorm();
  if (a_b * b_c <= b_b * a_c && a_b >= 0 && b_b <= 0) {
    return (from_a - a_b / ab_ab * ab).squaredNorm();
  }
  if (c_b * a_c <= a_b * c_c && a_c >= 0 && c_c <= 0) {
    return (from_a - a_c / ac_ac * ac).squaredNorm();
  }
  const double to_c = b_c - b_b, to_b = c_b - c_c;
  if (b_b * c_c <= c_b * b_c && to_c >= 0 && to_b >= 0) {
    return (from_a - ab - to_c / (to_c + to_b) * (ac - ab)).squaredNorm();
  }
  const double height = normal.dot(from_a);
  return height * height / normal2;
}

SurfaceDistance::SurfaceDistance(TriangleMesh mesh)
    : facets_(mesh.begin(), mesh.end()), tree_(boxes_of(mesh)) {}

NearestPart SurfaceDistance::find(const Vec3& point, double limit) const {
  poll_interrupt();
  const auto distance_to = [&](int i) {
    return std::sqrt(facets_[as_index(i)].squared_distance(point));
  };
  return tree_.nearest({point, point}, distance_to, limit);
}

Vec3 SurfaceDistance::nearest(const Vec3& point, double limit) const {
  return nearest_on(point, facets_[as_index(find(point, limit).part)].triangle);
}

}  // namespace mneme::internal
