// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The small pieces of surface and inside that a cover must hold.
#pragma once

#include <span>
#include <vector>

#include "covering/solid_model.h"
#include "covering/triangle_mesh.h"

namespace mneme::internal {

/// A piece is the convex hull of balls. A sphere that holds its balls holds all of it, so that a
/// cover of the pieces leaves no gap between sampled points.
struct Element {
  Sphere bound;  ///< holds the piece; the centre lies in it
  std::vector<Sphere> balls;

  /// The least radius of a sphere about `center` that holds the piece.
  [[nodiscard]] double reach_from(const Vec3& center) const;
  [[nodiscard]] bool is_within(const Sphere& sphere) const;
};

/// Pieces of about `size` metres: all of the surface, and all cells inside.
[[nodiscard]] std::vector<Element> make_elements(const TriangleMesh& mesh, const SolidModel& solid,
                                                 double size);

}  // namespace mneme::internal
