// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/obstacle_outline.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>

namespace mneme::internal {
namespace {

constexpr int kCirclePoints = 64;

double turn(const Point& a, const Point& b, const Point& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// One side of the convex hull of sorted points, by Andrew's monotone chain.
template <class Iterator>
void append_chain(Iterator first, Iterator last, Polygon& hull) {
  const std::size_t start = hull.size();
  for (; first != last; ++first) {
    while (hull.size() >= start + 2 && turn(hull[hull.size() - 2], hull.back(), *first) <= 0) {
      hull.pop_back();
    }
    hull.push_back(*first);
  }
  hull.pop_back();
}

std::optional<Outline> shadow(const std::vector<Vec3>& points) {
  const auto [low, high] = std::ranges::minmax(points, {}, [](const Vec3& p) { return p.z(); });
  if (low.z() > 0 || high.z() < 0) return std::nullopt;
  Polygon sorted;
  for (const Vec3& p : points) sorted.push_back({p.x(), p.y()});
  std::ranges::sort(sorted, {}, [](const Point& p) { return std::pair(p.x, p.y); });
  Polygon hull;
  append_chain(sorted.begin(), sorted.end(), hull);
  append_chain(sorted.rbegin(), sorted.rend(), hull);
  return hull;
}

/// A circle about the z axis of `pose`, at height `z` there.
void append_circle(const Transform& pose, double z, double radius, std::vector<Vec3>& points) {
  for (int i = 0; i < kCirclePoints; ++i) {
    const double angle = 2 * std::numbers::pi * i / kCirclePoints;
    points.push_back(pose * Vec3(radius * std::cos(angle), radius * std::sin(angle), z));
  }
}

std::optional<Outline> outline_of(const Sphere& sphere) {
  const double z = sphere.center.z();
  if (std::abs(z) > sphere.radius) return std::nullopt;
  return Disc{{sphere.center.x(), sphere.center.y()},
              std::sqrt(sphere.radius * sphere.radius - z * z)};
}

std::optional<Outline> outline_of(const Box& box) {
  std::vector<Vec3> points;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 signs((corner & 1) * 2 - 1, (corner & 2) - 1, (corner & 4) / 2 - 1);
    points.push_back(box.pose * box.half_extents.cwiseProduct(signs).eval());
  }
  return shadow(points);
}

std::optional<Outline> outline_of(const Cylinder& cylinder) {
  std::vector<Vec3> points;
  append_circle(cylinder.pose, cylinder.length / 2, cylinder.radius, points);
  append_circle(cylinder.pose, -cylinder.length / 2, cylinder.radius, points);
  return shadow(points);
}

std::optional<Outline> outline_of(const Capsule& capsule) {
  const auto [low, high] = std::minmax(capsule.a.z(), capsule.b.z());
  if (low > capsule.radius || high < -capsule.radius) return std::nullopt;
  std::vector<Vec3> points;
  for (const Vec3& end : {capsule.a, capsule.b}) {
    append_circle({Eigen::Matrix3d::Identity(), {end.x(), end.y(), 0}}, 0, capsule.radius, points);
  }
  return shadow(points);
}

}  // namespace

std::optional<Outline> planar_outline(const Shape& shape) {
  return std::visit([](const auto& solid) { return outline_of(solid); }, shape);
}

Bounds bounds_of(const Outline& outline) {
  Bounds bounds;
  if (const Disc* disc = std::get_if<Disc>(&outline)) {
    bounds.include(disc->center, disc->radius);
  } else {
    bounds.include(std::get<Polygon>(outline));
  }
  return bounds;
}

}  // namespace mneme::internal
