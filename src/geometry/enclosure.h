// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Which side of a surface a point is on, by lines through it.
#pragma once

#include "geometry/parts.h"

#include <algorithm>
#include <array>

namespace mneme::internal {

/// How often a line crosses a surface on either side of a point.
struct Crossings {
  int ahead = 0, behind = 0;
  [[nodiscard]] bool are_odd() const { return ahead % 2 == 1 && behind % 2 == 1; }
};

/// A line through a point.
class Line {
 public:
  Line(const Vec3& origin, const Vec3& direction)
      : origin_(origin), direction_(direction), inverse_(direction.cwiseInverse()) {}

  [[nodiscard]] bool meets(const AxisBox& box) const;
  /// Counts the triangle if it is crossed.
  void cross(const Triangle& triangle, Crossings& crossings) const;

 private:
  Vec3 origin_, direction_, inverse_;
};

/// How often `line` crosses the triangles of a surface.
[[nodiscard]] Crossings crossings_of(const Line& line, const Parts<Triangle>& surface);

/// In no plane that models tend to have faces in, so that a line rarely runs along an edge.
[[nodiscard]] const std::array<Vec3, 5>& line_directions();

/// True if most of five fixed lines through `point` cross the surface an odd number of times on
/// either side. The direction in which triangles turn does not matter, and holes rarely do.
/// `crossings_of(line)` counts.
template <class CrossingsOf>
[[nodiscard]] bool is_enclosed(const Vec3& point, const CrossingsOf& crossings_of) {
  int yes = 0, no = 0;
  for (const Vec3& direction : line_directions()) {
    ++(crossings_of(Line(point, direction)).are_odd() ? yes : no);
    if (std::max(yes, no) == 3) break;
  }
  return yes == 3;
}
[[nodiscard]] inline bool is_enclosed(const Vec3& point, const Parts<Triangle>& surface) {
  return is_enclosed(point, [&](const Line& line) { return crossings_of(line, surface); });
}

}  // namespace mneme::internal
