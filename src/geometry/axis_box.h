// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Axis-aligned boxes.
#pragma once

#include "mneme/geometry.h"

#include <limits>
#include <vector>

namespace mneme::internal {

/// Least and greatest coordinates. Empty by default.
struct AxisBox {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 high = -low;

  void include(const Vec3& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  void include(const AxisBox& other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
  }
  [[nodiscard]] bool is_empty() const { return !(low.array() <= high.array()).all(); }
  [[nodiscard]] bool contains(const AxisBox& other) const {
    return (low.array() <= other.low.array()).all() && (high.array() >= other.high.array()).all();
  }
};

[[nodiscard]] inline AxisBox intersection(const AxisBox& a, const AxisBox& b) {
  return {a.low.cwiseMax(b.low), a.high.cwiseMin(b.high)};
}

/// Squared distance between two boxes.
[[nodiscard]] inline double distance2(const AxisBox& a, const AxisBox& b) {
  return (b.low - a.high).cwiseMax(a.low - b.high).cwiseMax(0.0).squaredNorm();
}

[[nodiscard]] inline Vec3 to_vec3(const CloudPoint& p) { return {p[0], p[1], p[2]}; }

[[nodiscard]] inline AxisBox box_of(const CloudPoint& p) { return {to_vec3(p), to_vec3(p)}; }

/// Empty if a corner is not finite.
[[nodiscard]] inline AxisBox box_of(const Triangle& t) {
  if (!Vec3(t.a + t.b + t.c).allFinite()) return {};
  return {t.a.cwiseMin(t.b).cwiseMin(t.c), t.a.cwiseMax(t.b).cwiseMax(t.c)};
}
[[nodiscard]] inline AxisBox box_of(const Cube& c) {
  const Vec3 half = Vec3::Constant(c.half_extent);
  return {c.center - half, c.center + half};
}

[[nodiscard]] inline AxisBox box_of(const Capsule& c) {
  const Vec3 reach = Vec3::Constant(c.radius);
  return {c.a.cwiseMin(c.b) - reach, c.a.cwiseMax(c.b) + reach};
}

template <class Part>
[[nodiscard]] std::vector<AxisBox> boxes_of(const std::vector<Part>& parts) {
  std::vector<AxisBox> boxes;
  boxes.reserve(parts.size());
  for (const Part& part : parts) boxes.push_back(box_of(part));
  return boxes;
}

/// The box around all parts. Empty if the box of any part is empty, such as a cube of negative
/// size.
template <class Part>
[[nodiscard]] AxisBox box_around(const std::vector<Part>& parts) {
  AxisBox box;
  for (const Part& part : parts) {
    const AxisBox own = box_of(part);
    if (own.is_empty()) return {};
    box.include(own);
  }
  return box;
}

}  // namespace mneme::internal
