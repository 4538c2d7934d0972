// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The passage between two obstacles.
#pragma once

#include "mneme/scene.h"

#include <limits>
#include <optional>

namespace mneme::internal {

/// The two shapes of two obstacles that are closest to each other.
struct ClosestShapes {
  const Shape* a = nullptr;  ///< null if no pair of shapes can be as close as asked
  const Shape* b = nullptr;
  double distance = std::numeric_limits<double>::infinity();
};
/// Shapes whose bounding spheres are further apart than `most` are not looked at.
[[nodiscard]] ClosestShapes closest_shapes(const Obstacle& a, const Obstacle& b, double most);

/// The line from surface to surface across a passage.
struct Passage {
  Vec3 a = Vec3::Zero(), b = Vec3::Zero();

  [[nodiscard]] Vec3 middle() const { return 0.5 * (a + b); }
  [[nodiscard]] double width() const { return (b - a).norm(); }
};
/// Where the passage between two obstacles is narrowest; where it is equally narrow along a line or
/// a face, the place nearest to the midpoint of the two shapes' centres. Nothing if they touch or
/// are further apart than `most`. A motion of both obstacles moves it along.
[[nodiscard]] std::optional<Passage> find_passage(const Obstacle& a, const Obstacle& b,
                                                  double most);

}  // namespace mneme::internal
