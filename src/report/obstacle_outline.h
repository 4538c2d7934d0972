// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Obstacles as seen in the plane z = 0.
#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "mneme/geometry.h"
#include "report/planar_view.h"

namespace mneme::internal {

struct Disc {
  Point center;
  double radius = 0;
};
using Polygon = std::vector<Point>;  ///< convex, counter-clockwise
using Outline = std::variant<Disc, Polygon>;

/// What a planar robot meets of `shape`, or nothing if the shape stays clear of its plane: the
/// section of a sphere, and the shadow of any other shape along z, which is its section if it
/// stands upright.
[[nodiscard]] std::optional<Outline> planar_outline(const Shape& shape);

[[nodiscard]] Bounds bounds_of(const Outline& outline);

}  // namespace mneme::internal
