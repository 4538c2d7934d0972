// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Exact distances from segments, boxes and parts of compound shapes, and tests of enclosure.
#pragma once

#include "mneme/geometry.h"

#include "geometry/parts.h"

#include <algorithm>
#include <array>
#include <limits>

namespace mneme::internal {

/// Vector from the nearest point of the segment ab to `p`.
[[nodiscard]] Vec3 excess_of_segment(const Vec3& p, const Vec3& a, const Vec3& b);
/// Vector from the nearest point of a box around the origin to `p`: zero inside.
[[nodiscard]] Vec3 excess_of_box(const Vec3& p, const Vec3& half_extents);
/// Distance between the segment ab and a box around the origin.
[[nodiscard]] double distance_to_box(const Vec3& a, const Vec3& b, const Vec3& half_extents);

/// Triangles whose corner has a smaller squared sine are slivers: double precision cannot determine
/// their plane. Their edges replace them, with an error below 5e-8 of the length.
inline constexpr double kLeastSine2 = 1e-14;

/// The normal (b - a) x (c - a). Zero for slivers, whose squared sine at `a` is at most
/// `least_sine2`: rounding would determine the direction.
[[nodiscard]] Vec3 normal_of(const Triangle& t, double least_sine2 = kLeastSine2);

/// The point of a part nearest to `p`; `p` itself inside a cube.
[[nodiscard]] Vec3 nearest_on(const Vec3& p, const CloudPoint& point);
[[nodiscard]] Vec3 nearest_on(const Vec3& p, const Triangle& triangle);
[[nodiscard]] Vec3 nearest_on(const Vec3& p, const Cube& cube);

/// Distance between the segment ab, which may be a point, and a part: 0 if they meet.
[[nodiscard]] double distance_between(const Vec3& a, const Vec3& b, const CloudPoint& point);
[[nodiscard]] double distance_between(const Vec3& a, const Vec3& b, const Triangle& triangle);
[[nodiscard]] double distance_between(const Vec3& a, const Vec3& b, const Cube& cube);

/// Distance between two triangles, 0 if they meet. `limit` if they are at least that far apart.
[[nodiscard]] double distance_between(const Triangle& s, const Triangle& t, double limit);

/// Distance between a triangle and a convex solid or a part: 0 if they meet. To a cylinder it is
/// exact to within 1e-9 m.
[[nodiscard]] double distance_between(const Triangle& t, const Box& box);
[[nodiscard]] double distance_between(const Triangle& t, const Cylinder& cylinder);
[[nodiscard]] double distance_between(const Triangle& t, const CloudPoint& point);
[[nodiscard]] double distance_between(const Triangle& t, const Cube& cube);

/// The part nearest to the segment ab, without the radius, if closer than `limit`. The segment is
/// in the parts' frame.
template <class Part>
[[nodiscard]] NearestPart nearest_part(const CompoundShape<Part>& compound, const Vec3& a,
                                       const Vec3& b,
                                       double limit = std::numeric_limits<double>::infinity()) {
  const std::vector<Part>& list = compound.parts->list();
  const auto distance_to = [&](int i) {
    return distance_between(a, b, list[static_cast<std::size_t>(i)]);
  };
  return PartsAccess::tree(*compound.parts)
      ->nearest({a.cwiseMin(b), a.cwiseMax(b)}, distance_to, limit);
}

/// Numbers of crossings of a line and a surface, ahead of and behind the line's origin.
struct Crossings {
  int ahead = 0, behind = 0;
  [[nodiscard]] bool are_odd() const { return ahead % 2 == 1 && behind % 2 == 1; }
};

/// A line through `origin`.
class Line {
 public:
  Line(const Vec3& origin, const Vec3& direction)
      : origin_(origin), direction_(direction), inverse_(direction.cwiseInverse()) {}

  [[nodiscard]] bool meets(const AxisBox& box) const;
  /// Adds the crossing with a triangle, if any.
  void cross(const Triangle& triangle, Crossings& crossings) const;

 private:
  Vec3 origin_, direction_, inverse_;
};

/// Crossings of `line` with the triangles of a surface.
[[nodiscard]] Crossings crossings_of(const Line& line, const Parts<Triangle>& surface);

/// Directions outside of the planes in which models tend to have faces, so that lines rarely run
/// along an edge.
[[nodiscard]] const std::array<Vec3, 5>& line_directions();

/// True if three of five lines through `point` cross the surface an odd number of times on both
/// sides. Independent of triangle orientation and robust to holes. `crossings_of(line)` counts.
template <class CrossingsOf>
[[nodiscard]] bool is_enclosed(const Vec3& point, const CrossingsOf& crossings_of) {
  int yes = 0, no = 0;
  for (const Vec3& direction : line_directions()) {
    ++(crossings_of(Line(point, direction)).are_odd() ? yes : no);
    if (std::max(yes, no) == 3) break;
  }
  return yes == 3;
}

}  // namespace mneme::internal
