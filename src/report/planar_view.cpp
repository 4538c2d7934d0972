// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/picture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mneme::internal {
namespace {

constexpr double kMargin = 26;  // pixels between the bounds and the panel's edge
constexpr double kFlattest = 0.5;
constexpr double kTallest = 1.05;
constexpr double kSmallestExtent = 0.1;  // metres, so that a point alone has a scale

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
  Polygon flat;
  for (const Vec3& p : points) flat.push_back({p.x(), p.y()});
  return convex_hull(std::move(flat));
}

/// Appends a circle about the z axis of `pose`, at height `z` in its frame.
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

/// Compound shapes are not shown.
template <class Part>
std::optional<Outline> outline_of(const CompoundShape<Part>& /*compound*/) {
  return std::nullopt;
}

}  // namespace

Polygon convex_hull(Polygon points) {
  std::ranges::sort(points, {}, [](const Point& p) { return std::pair(p.x, p.y); });
  Polygon hull;
  append_chain(points.begin(), points.end(), hull);
  append_chain(points.rbegin(), points.rend(), hull);
  return hull;
}

void Bounds::include(const Point& point, double margin) {
  left = std::min(left, point.x - margin);
  right = std::max(right, point.x + margin);
  bottom = std::min(bottom, point.y - margin);
  top = std::max(top, point.y + margin);
}

void Bounds::include(std::span<const Point> points) {
  for (const Point& point : points) include(point);
}

Bounds Bounds::clipped(const Bounds& other) const {
  return {std::max(left, other.left), std::min(right, other.right), std::max(bottom, other.bottom),
          std::min(top, other.top)};
}

PlanarView::PlanarView(const Bounds& bounds, const Point& corner, double width)
    : center_{(bounds.left + bounds.right) / 2, (bounds.bottom + bounds.top) / 2} {
  const double extent_x = std::max(bounds.width(), kSmallestExtent);
  const double extent_y = std::max(bounds.height(), kSmallestExtent);
  const double inner_width = width - 2 * kMargin;
  const double wanted = inner_width * extent_y / extent_x + 2 * kMargin;
  height_ = std::clamp(wanted, kFlattest * width, kTallest * width);
  scale_ = std::min(inner_width / extent_x, (height_ - 2 * kMargin) / extent_y);
  middle_ = {corner.x + width / 2, corner.y + height_ / 2};
}

Point PlanarView::pixel(const Point& metres) const {
  return {middle_.x + scale_ * (metres.x - center_.x), middle_.y - scale_ * (metres.y - center_.y)};
}

std::vector<Point> PlanarView::pixels(std::span<const Point> metres) const {
  std::vector<Point> points;
  points.reserve(metres.size());
  for (const Point& point : metres) points.push_back(pixel(point));
  return points;
}

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
