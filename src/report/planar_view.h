// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The map from the plane in metres, y upwards, to the pixels of a picture, y downwards.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "report/svg_writer.h"

namespace mneme::internal {

/// An axis-aligned rectangle that grows; metres.
struct Bounds {
  double left = std::numeric_limits<double>::infinity();
  double right = -std::numeric_limits<double>::infinity();
  double bottom = std::numeric_limits<double>::infinity();
  double top = -std::numeric_limits<double>::infinity();

  void include(const Point& point, double margin = 0);
  void include(std::span<const Point> points);
  /// The part of this that lies in `other`; empty if none does.
  [[nodiscard]] Bounds clipped(const Bounds& other) const;
  [[nodiscard]] bool is_empty() const { return left > right || bottom > top; }
  [[nodiscard]] double width() const { return right - left; }
  [[nodiscard]] double height() const { return top - bottom; }
};

/// Shows bounds, with a margin, in the middle of a panel of a given width; its height follows from
/// the aspect ratio, kept between a letterbox and a square or so.
class PlanarView {
 public:
  PlanarView(const Bounds& bounds, const Point& corner, double width);

  [[nodiscard]] Point pixel(const Point& metres) const;
  [[nodiscard]] std::vector<Point> pixels(std::span<const Point> metres) const;
  /// Pixels per metre.
  [[nodiscard]] double scale() const { return scale_; }
  [[nodiscard]] double height() const { return height_; }

 private:
  Point center_;  // of the bounds, metres
  Point middle_;  // of the panel, pixels
  double scale_ = 1;
  double height_ = 0;
};

}  // namespace mneme::internal
