// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/geometry.h"

#include <array>

#include "geometry/excess.h"

namespace mneme {
namespace {

/// Along a segment the squared distance from a box is convex and, between the parameters where a
/// coordinate passes a face, quadratic: the least of the values there and at each piece's vertex is
/// the minimum.
double distance_to_box(const Vec3& a, const Vec3& b, const Vec3& half_extents) {
  const Vec3 along = b - a;
  std::array<double, 8> breaks;
  breaks.fill(1.0);
  std::size_t count = 0;
  breaks[count++] = 0.0;
  for (int i = 0; i < 3; ++i) {
    for (const double face : {-half_extents[i], half_extents[i]}) {
      const double t = (face - a[i]) / along[i];
      if (t > 0.0 && t < 1.0) {
        breaks[count++] = t;
      }
    }
  }
  std::sort(breaks.begin(), breaks.end());

  const auto excess = [&](double t) {
    return internal::excess_of_box(a + t * along, half_extents);
  };
  double least = std::min(excess(0.0).norm(), internal::excess_of_box(b, half_extents).norm());
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

/// The squared distance from a convex solid is convex along a segment: bisects for the zero of its
/// slope.
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
    return distance_to_box(to_box * a, to_box * b, s.half_extents);
  }
  double operator()(const Cylinder& s) const {
    const Transform to_cylinder = s.pose.inverse();
    return distance_to_cylinder(to_cylinder * a, to_cylinder * b, s.radius, s.length);
  }
  double operator()(const Capsule& s) const {
    return std::max(0.0, segment_distance(a, b, s.a, s.b) - s.radius);
  }
};

}  // namespace

double distance_to_segment(const Vec3& a, const Vec3& b, const Shape& shape) {
  return a == b ? distance(a, shape) : std::visit(FromSegment{a, b}, shape);
}

}  // namespace mneme
