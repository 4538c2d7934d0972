// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Exact distances from segments, boxes and parts of compound shapes, and tests of enclosure.
#pragma once

#include "mneme/geometry.h"

#include "geometry/parts.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>

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
  int exits_ahead = 0, exits_behind = 0;  ///< crossings towards a triangle's front, less the others
  [[nodiscard]] bool are_odd() const { return ahead % 2 == 1 && behind % 2 == 1; }
  [[nodiscard]] bool leave() const { return ahead == 0 || behind == 0; }
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

/// Returns point `index` of `count` that a spiral spreads evenly over the unit sphere.
[[nodiscard]] Vec3 spiral_point(int index, int count);

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

/// Returns how often a closed surface winds around a point: 0 outside, also where solids overlap. A
/// line through an edge may miscount, mostly on one side of the point: then another one is tried.
/// Returns nothing if both sides of all lines disagree. `crossings_of(line)` counts.
template <class CrossingsOf>
[[nodiscard]] std::optional<int> winding_number(const Vec3& point,
                                                const CrossingsOf& crossings_of) {
  for (const Vec3& direction : line_directions()) {
    const Crossings crossings = crossings_of(Line(point, direction));
    if (crossings.exits_ahead == crossings.exits_behind) return crossings.exits_ahead;
  }
  return std::nullopt;
}

}  // namespace mneme::internal
