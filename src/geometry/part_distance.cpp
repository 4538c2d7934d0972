// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/part_distance.h"

#include "geometry/segments.h"

#include <Eigen/Geometry>

#include <algorithm>

namespace mneme::internal {
namespace {

Vec3 to_vec3(const CloudPoint& p) { return {p[0], p[1], p[2]}; }

/// True if the segment ab goes through the triangle. By Moller and Trumbore, DOI
/// 10.1080/10867651.1997.10487468. In its plane it meets an edge.
bool crosses(const Vec3& a, const Vec3& b, const Triangle& t) {
  const Vec3 direction = b - a, u_edge = t.b - t.a, v_edge = t.c - t.a;
  const Vec3 p = direction.cross(v_edge);
  const double determinant = u_edge.dot(p);
  if (determinant == 0) return false;
  const Vec3 offset = a - t.a;
  const double u = offset.dot(p) / determinant;
  const Vec3 q = offset.cross(u_edge);
  const double v = direction.dot(q) / determinant;
  const double along = v_edge.dot(q) / determinant;
  return u >= 0 && v >= 0 && u + v <= 1 && along >= 0 && along <= 1;
}

}  // namespace

Vec3 nearest_on(const Vec3& /*p*/, const CloudPoint& point) { return to_vec3(point); }

Vec3 nearest_on(const Vec3& p, const Triangle& t) {
  const Vec3 normal = (t.b - t.a).cross(t.c - t.a);
  const auto is_left = [&](const Vec3& a, const Vec3& b) {
    return normal.dot((b - a).cross(p - a)) >= 0;
  };
  const double area2 = normal.squaredNorm();
  if (area2 > 0 && is_left(t.a, t.b) && is_left(t.b, t.c) && is_left(t.c, t.a)) {
    return p - normal.dot(p - t.a) / area2 * normal;
  }
  Vec3 best = excess_of_segment(p, t.a, t.b);
  for (const Vec3& excess : {excess_of_segment(p, t.b, t.c), excess_of_segment(p, t.c, t.a)}) {
    if (excess.squaredNorm() < best.squaredNorm()) best = excess;
  }
  return p - best;
}

Vec3 nearest_on(const Vec3& p, const Cube& cube) {
  return p - excess_of_box(p - cube.center, Vec3::Constant(cube.half_extent));
}

double distance_between(const Vec3& a, const Vec3& b, const CloudPoint& point) {
  return excess_of_segment(to_vec3(point), a, b).norm();
}

double distance_between(const Vec3& a, const Vec3& b, const Triangle& t) {
  const double from_a = (a - nearest_on(a, t)).norm();
  if (a == b) return from_a;
  if (crosses(a, b, t)) return 0;
  return std::min({from_a, (b - nearest_on(b, t)).norm(), segment_distance(a, b, t.a, t.b),
                   segment_distance(a, b, t.b, t.c), segment_distance(a, b, t.c, t.a)});
}

double distance_between(const Vec3& a, const Vec3& b, const Cube& cube) {
  const Vec3 half = Vec3::Constant(cube.half_extent);
  if (a == b) return excess_of_box(a - cube.center, half).norm();
  return distance_to_box(a - cube.center, b - cube.center, half);
}

}  // namespace mneme::internal
