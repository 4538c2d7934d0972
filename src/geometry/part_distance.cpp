// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/part_distance.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>

namespace mneme::internal {
namespace {

/// True if the segment ab crosses the triangle with this normal_of(). By Moller and Trumbore,
/// DOI 10.1080/10867651.1997.10487468. False within the plane: such segments meet an edge.
bool crosses(const Vec3& a, const Vec3& b, const Triangle& t, const Vec3& normal) {
  const Vec3 direction = b - a, offset = a - t.a;
  const double determinant = -normal.dot(direction);
  if (determinant == 0) return false;
  const Vec3 moment = offset.cross(direction);
  const double u = moment.dot(t.c - t.a) / determinant;
  const double v = moment.dot(t.a - t.b) / determinant;
  const double along = normal.dot(offset) / determinant;
  return u >= 0 && v >= 0 && u + v <= 1 && along >= 0 && along <= 1;
}

}  // namespace

Vec3 normal_of(const Triangle& t, double least_sine2) {
  const Vec3 u = t.b - t.a, v = t.c - t.a, normal = u.cross(v);
  const bool is_certain = normal.squaredNorm() > least_sine2 * u.squaredNorm() * v.squaredNorm();
  return is_certain ? normal : Vec3::Zero();
}

Vec3 nearest_on(const Vec3& /*p*/, const CloudPoint& point) { return to_vec3(point); }

Vec3 nearest_on(const Vec3& p, const Triangle& t) {
  const Vec3 normal = normal_of(t);
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
  if (crosses(a, b, t, normal_of(t))) return 0;
  return std::min({from_a, (b - nearest_on(b, t)).norm(), segment_distance(a, b, t.a, t.b),
                   segment_distance(a, b, t.b, t.c), segment_distance(a, b, t.c, t.a)});
}

double distance_between(const Vec3& a, const Vec3& b, const Cube& cube) {
  const Vec3 half = Vec3::Constant(cube.half_extent);
  if (a == b) return excess_of_box(a - cube.center, half).norm();
  return distance_to_box(a - cube.center, b - cube.center, half);
}

namespace {

/// Lines with a smaller squared sine between them count as parallel.
constexpr double kParallel = 1e-15;

/// Squared distance between the segments from `a` along `u` and from `c` along `v`. By Ericson,
/// Real-Time Collision Detection (2005), 5.1.9. Rounding never makes it too small.
double squared_distance(const Vec3& a, const Vec3& u, const Vec3& c, const Vec3& v) {
  const Vec3 r = a - c;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v);
  const double ur = u.dot(r), vr = v.dot(r);
  const auto share = [](double x, double of) { return of > 0 ? std::clamp(x / of, 0.0, 1.0) : 0; };
  const double determinant = uu * vv - uv * uv;
  const double first =
      determinant > kParallel * uu * vv ? share(uv * vr - vv * ur, determinant) : 0;
  const double along_v = share(uv * first + vr, vv);
  const double along_u = share(uv * along_v - ur, uu);
  return (r + along_u * u - along_v * v).squaredNorm();
}

/// A triangle with precomputed edges and normal.
struct Facet {
  explicit Facet(const Triangle& t)
      : corners{t.a, t.b, t.c},
        edges{t.b - t.a, t.c - t.b, t.a - t.c},
        normal(normal_of(t)),
        normal2(normal.squaredNorm()) {}

  [[nodiscard]] bool is_above_or_below(const Vec3& p) const {
    for (std::size_t i = 0; i < 3; ++i) {
      if (normal.dot(edges[i].cross(p - corners[i])) < 0) return false;
    }
    return true;
  }

  std::array<Vec3, 3> corners, edges;
  Vec3 normal;  ///< zero for slivers
  double normal2;
};

/// Heights of a facet's corners over the plane of another one, in multiples of its normal's length.
struct Heights {
  Heights(const Facet& of, const Facet& over) {
    for (std::size_t i = 0; i < 3; ++i) at[i] = over.normal.dot(of.corners[i] - over.corners[0]);
    const auto [low, high] = std::minmax({at[0], at[1], at[2]});
    least = std::max(low, -high);
  }
  std::array<double, 3> at;
  double least;  ///< at most 0 if the plane separates some corners
};

/// Lowers `least2` to the squared distance of corners above or below the other facet.
void compare_corners(const Facet& of, const Facet& over, const Heights& heights, double& least2) {
  for (std::size_t i = 0; i < 3; ++i) {
    const double square = heights.at[i] * heights.at[i];
    if (!(square < least2 * over.normal2) || !over.is_above_or_below(of.corners[i])) continue;
    least2 = square / over.normal2;
  }
}

/// True if the projections on the line between the centroids are sqrt(limit2) apart.
bool are_apart(const Facet& s, const Facet& t, double limit2) {
  const auto sum = [](const Facet& f) -> Vec3 {
    return f.corners[0] + f.corners[1] + f.corners[2];
  };
  const Vec3 axis = sum(t) - sum(s);
  const auto at = [&](const Vec3& p) { return axis.dot(p); };
  const double gap = std::min({at(t.corners[0]), at(t.corners[1]), at(t.corners[2])}) -
                     std::max({at(s.corners[0]), at(s.corners[1]), at(s.corners[2])});
  return gap > 0 && gap * gap >= limit2 * axis.squaredNorm();
}

bool cross(const Facet& s, const Triangle& t, const Vec3& normal) {
  return crosses(s.corners[0], s.corners[1], t, normal) ||
         crosses(s.corners[1], s.corners[2], t, normal) ||
         crosses(s.corners[2], s.corners[0], t, normal);
}

}  // namespace

double distance_between(const Triangle& s, const Triangle& t, double limit) {
  const Facet own(s), other(t);
  double least2 = limit * limit;
  if (are_apart(own, other, least2)) return limit;
  const Heights over_other(own, other), over_own(other, own);
  const auto is_far = [&](const Heights& heights, double normal2) {
    return heights.least > 0 && heights.least * heights.least >= least2 * normal2;
  };
  if (is_far(over_other, other.normal2) || is_far(over_own, own.normal2)) return limit;
  const bool may_cross = over_other.least <= 0 && over_own.least <= 0;
  if (may_cross && (cross(own, t, other.normal) || cross(other, s, own.normal))) return 0;
  const double before = least2;
  compare_corners(own, other, over_other, least2);
  compare_corners(other, own, over_own, least2);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      least2 = std::min(
          least2, squared_distance(own.corners[i], own.edges[i], other.corners[k], other.edges[k]));
    }
  }
  return least2 < before ? std::sqrt(least2) : limit;
}

}  // namespace mneme::internal
