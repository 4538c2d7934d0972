// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tables/shape_groups.h"

#include "geometry/axis_box.h"

#include <algorithm>
#include <cmath>

namespace mneme::internal {
namespace {

/// Distance from `center` to the farthest point of a capsule; sets the `end` nearest to that point.
double reach_of(const Capsule& shape, const Vec3& center, Vec3& end) {
  const double a2 = (shape.a - center).squaredNorm(), b2 = (shape.b - center).squaredNorm();
  end = a2 > b2 ? shape.a : shape.b;
  return std::sqrt(std::max(a2, b2)) + shape.radius;
}

double farthest(std::span<const Capsule> shapes, const Vec3& center, Vec3& end) {
  double reach = 0;
  for (const Capsule& shape : shapes) {
    Vec3 candidate;
    const double r = reach_of(shape, center, candidate);
    if (r > reach) {
      reach = r;
      end = candidate;
    }
  }
  return reach;
}

/// The middle of the shapes' bounding box.
Vec3 middle(std::span<const Capsule> shapes) {
  AxisBox box;
  for (const Capsule& shape : shapes) box.include(box_of(shape));
  return (box.low + box.high) / 2;
}

Vec3 center_of(const Capsule& shape) { return (shape.a + shape.b) / 2; }

void cut(std::span<Capsule> shapes, std::size_t begin, std::size_t most,
         std::vector<std::size_t>& ends) {
  if (shapes.size() <= most) {
    ends.push_back(begin + shapes.size());
    return;
  }
  AxisBox centers;
  for (const Capsule& shape : shapes) centers.include(center_of(shape));
  Eigen::Index axis = 0;
  (centers.high - centers.low).maxCoeff(&axis);
  std::stable_sort(shapes.begin(), shapes.end(), [axis](const Capsule& a, const Capsule& b) {
    return a.a[axis] + a.b[axis] < b.a[axis] + b.b[axis];
  });
  // Full groups to the left, so that only the last one is not full.
  const std::size_t groups = (shapes.size() + most - 1) / most;
  const std::size_t half = shapes.size() * (groups / 2) / groups;
  cut(shapes.first(half), begin, most, ends);
  cut(shapes.subspan(half), begin + half, most, ends);
}

}  // namespace

Sphere enclosing_ball(std::span<const Capsule> shapes) {
  Sphere best{middle(shapes), 0};
  Vec3 end = best.center;
  best.radius = farthest(shapes, best.center, end);
  if (shapes.size() == 1) return best;
  // Badoiu and Clarkson's method: ever shorter steps towards the farthest point.
  Vec3 center = best.center;
  for (int step = 2; step < 18; ++step) {
    center += (end - center) / (2.0 * step);
    const double radius = farthest(shapes, center, end);
    if (radius < best.radius) best = {center, radius};
  }
  return best;
}

Sphere enclosing_ball(const Sphere& a, const Sphere& b) {
  const Vec3 apart = b.center - a.center;
  const double distance = apart.norm();
  if (distance + b.radius <= a.radius) return a;
  if (distance + a.radius <= b.radius) return b;
  const double radius = (distance + a.radius + b.radius) / 2;
  return {a.center + (radius - a.radius) / distance * apart, radius};
}

std::vector<std::size_t> sort_into_groups(std::span<Capsule> shapes, std::size_t most) {
  std::vector<std::size_t> ends;
  if (!shapes.empty()) cut(shapes, 0, most, ends);
  return ends;
}

}  // namespace mneme::internal
