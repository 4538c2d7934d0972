// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/as_index.h"
#include "geometry/part_distance.h"
#include "geometry/solids.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <limits>

namespace mneme::internal {

Vec3 excess_of_box(const Vec3& p, const Vec3& half_extents) {
  return p - p.cwiseMax(-half_extents).cwiseMin(half_extents);
}

// Both ends are candidates, because on very short segments rounding spoils the parameter of the
// nearest point.
Vec3 excess_of_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0.0 ? std::clamp((p - a).dot(along) / length2, 0.0, 1.0) : 0.0;
  Vec3 nearest = p - a - t * along;
  for (const Vec3& end : {a, b}) {
    if ((p - end).squaredNorm() < nearest.squaredNorm()) nearest = p - end;
  }
  return nearest;
}

// Along a segment the squared distance to a box is convex, and quadratic between the parameters
// where a coordinate passes a face. So the minimum is at one of these or at a vertex between them.
double distance_to_box(const Vec3& a, const Vec3& b, const Vec3& half_extents) {
  const Vec3 along = b - a;
  std::array<double, 8> breaks;
  breaks.fill(1.0);
  std::size_t count = 0;
  breaks[count++] = 0.0;
  for (int i = 0; i < 3; ++i) {
    for (const double face : {-half_extents[i], half_extents[i]}) {
      const double t = (face - a[i]) / along[i];
      if (t > 0.0 && t < 1.0) breaks[count++] = t;
    }
  }
  std::sort(breaks.begin(), breaks.end());

  const auto excess = [&](double t) { return excess_of_box(a + t * along, half_extents); };
  double least = std::min(excess(0.0).norm(), excess_of_box(b, half_extents).norm());
  for (std::size_t i = 1; i < breaks.size(); ++i) {
    const double low = breaks[i - 1];
    const double high = breaks[i];
    const double slope_low = excess(low).dot(along);
    const double slope_high = excess(high).dot(along);
    const double rise = slope_high - slope_low;
    const double step = rise > 0.0 ? std::clamp(-slope_low / rise, 0.0, 1.0) : 0.0;
    least = std::min({least, excess(high).norm(), excess(low + step * (high - low)).norm()});
  }
  return least;
}

namespace {

/// Vector from the nearest point of a cylinder around the z axis to `p`: zero inside.
Vec3 excess_of_cylinder(const Vec3& p, double radius, double length) {
  const double r = p.head<2>().norm();
  const double beyond_side = r > radius ? (r - radius) / r : 0.0;
  const double z = p.z() - std::clamp(p.z(), -0.5 * length, 0.5 * length);
  return {beyond_side * p.x(), beyond_side * p.y(), z};
}

}  // namespace

Vec3 nearest_point(const Vec3& p, const Box& box) {
  return p - box.pose.rotation * excess_of_box(box.pose.inverse() * p, box.half_extents);
}

Vec3 nearest_point(const Vec3& p, const Cylinder& cylinder) {
  return p - cylinder.pose.rotation *
                 excess_of_cylinder(cylinder.pose.inverse() * p, cylinder.radius, cylinder.length);
}

namespace {

struct NearestPoint {
  const Vec3& p;
  Vec3 operator()(const Sphere& s) const {
    const Vec3 out = p - s.center;
    const double length = out.norm();
    return length <= s.radius ? p : Vec3(s.center + s.radius / length * out);
  }
  Vec3 operator()(const Box& s) const { return nearest_point(p, s); }
  Vec3 operator()(const Cylinder& s) const { return nearest_point(p, s); }
  Vec3 operator()(const Capsule& s) const {
    const Vec3 out = excess_of_segment(p, s.a, s.b);
    const double length = out.norm();
    return length <= s.radius ? p : Vec3(p - (1 - s.radius / length) * out);
  }
  template <class Part>
  Vec3 operator()(const CompoundShape<Part>& s) const {
    const Vec3 local = s.pose.inverse() * p;
    const NearestPart nearest = nearest_part(s, local, local);
    const Vec3 on_part = nearest_on(local, s.parts->list()[as_index(nearest.part)]);
    if (nearest.distance <= s.radius) return p;
    return s.pose * Vec3(on_part + s.radius / nearest.distance * (local - on_part));
  }
};

}  // namespace

Vec3 nearest_point(const Vec3& p, const Shape& shape) { return std::visit(NearestPoint{p}, shape); }

}  // namespace mneme::internal

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
  template <class Part>
  double operator()(const CompoundShape<Part>& s) const {
    const Vec3 local = s.pose.inverse() * p;
    return std::max(0.0, internal::nearest_part(s, local, local).distance - s.radius);
  }
};

}  // namespace

double distance(const Vec3& point, const Shape& shape) {
  return std::visit(FromPoint{point}, shape);
}

double segment_distance(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  if (a == b) return internal::excess_of_segment(a, c, d).norm();
  if (c == d) return internal::excess_of_segment(c, a, b).norm();
  const Vec3 u = b - a;
  const Vec3 v = d - c;
  // Each candidate is the distance between two points of the segments, so rounding cannot make the
  // result too small. The ends are exact for parallel segments, the crossing for all others.
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

namespace {

/// Bisects for the zero of the slope: the squared distance to a convex solid is convex along a
/// segment.
double distance_to_cylinder(const Vec3& a, const Vec3& b, double radius, double length) {
  const Vec3 along = b - a;
  const auto excess = [&](double t) {
    return internal::excess_of_cylinder(a + t * along, radius, length);
  };
  double low = 0.0;
  double high = 1.0;
  double least =
      std::min(excess(0.0).norm(), internal::excess_of_cylinder(b, radius, length).norm());
  for (int halving = 0; halving < 60 && least > 0.0; ++halving) {
    const double middle = 0.5 * (low + high);
    const Vec3 here = excess(middle);
    least = std::min(least, here.norm());
    (here.dot(along) < 0.0 ? low : high) = middle;
  }
  return least;
}

struct FromSegment {
  const Vec3& a;
  const Vec3& b;
  double operator()(const Sphere& s) const {
    return std::max(0.0, internal::excess_of_segment(s.center, a, b).norm() - s.radius);
  }
  double operator()(const Box& s) const {
    const Transform to_box = s.pose.inverse();
    return internal::distance_to_box(to_box * a, to_box * b, s.half_extents);
  }
  double operator()(const Cylinder& s) const {
    const Transform to_cylinder = s.pose.inverse();
    return distance_to_cylinder(to_cylinder * a, to_cylinder * b, s.radius, s.length);
  }
  double operator()(const Capsule& s) const {
    return std::max(0.0, segment_distance(a, b, s.a, s.b) - s.radius);
  }
  template <class Part>
  double operator()(const CompoundShape<Part>& s) const {
    const Transform to_parts = s.pose.inverse();
    return std::max(0.0, internal::nearest_part(s, to_parts * a, to_parts * b).distance - s.radius);
  }
};

}  // namespace

double distance_to_segment(const Vec3& a, const Vec3& b, const Shape& shape) {
  return a == b ? distance(a, shape) : std::visit(FromSegment{a, b}, shape);
}

// Alternating projections (Cheney and Goldstein, DOI 10.2307/2033416) are projected gradient steps
// on half the squared distance. They converge slowly where solids meet at a slant. Momentum helps
// (Beck and Teboulle, DOI 10.1137/080716542), with restarts (O'Donoghue and Candes,
// DOI 10.1007/s10208-013-9150-3). Only a round without momentum decides that it has converged.
double distance(const Shape& a, const Shape& b) {
  constexpr int kMostRounds = 200;
  constexpr double kTolerance = 1e-6;
  Vec3 p = bounding_sphere(a).center;
  Vec3 from = p;
  double least = std::numeric_limits<double>::infinity();
  int momentum = 0;
  for (int round = 0; round < kMostRounds; ++round) {
    const Vec3 q = internal::nearest_point(from, b);
    const Vec3 next = internal::nearest_point(q, a);
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
