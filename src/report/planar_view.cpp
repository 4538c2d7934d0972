// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/planar_view.h"

#include <algorithm>

namespace mneme::internal {
namespace {

constexpr double kMargin = 26;  // pixels between the bounds and the panel's edge
constexpr double kFlattest = 0.5;
constexpr double kTallest = 1.05;
constexpr double kSmallestExtent = 0.1;  // metres, so that a point alone has a scale

}  // namespace

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

}  // namespace mneme::internal
