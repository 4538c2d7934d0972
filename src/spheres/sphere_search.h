// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Set cover: chooses few of many spheres that together contain all pieces of a solid.
#pragma once

#include "mneme/base.h"

#include "spheres/solid_model.h"
#include "spheres/triangle_mesh.h"

#include <cstdint>
#include <span>
#include <vector>

namespace mneme::internal {

/// A piece of a solid: the convex hull of balls. A sphere that contains the balls contains the
/// piece, so that a cover leaves no gap between sampled points.
struct Element {
  Sphere bound;  ///< contains the piece; the centre lies in it
  std::vector<Sphere> balls;

  /// Returns the radius of the smallest sphere around `center` that contains the piece.
  [[nodiscard]] double reach_from(const Vec3& center) const;
  [[nodiscard]] bool is_within(const Sphere& sphere) const;
};

/// Cuts the surface and the inner voxels into pieces of about `size` metres.
[[nodiscard]] std::vector<Element> make_elements(const TriangleMesh& mesh, const SolidModel& solid,
                                                 double size);

/// Proposes spheres around points on the solid's medial axis and on its surface, each as large as
/// `excess` allows. Such a sphere around any other point lies within one of these. `medial_balls`
/// come from the solid.
[[nodiscard]] std::vector<Sphere> propose_spheres(const SolidModel& solid,
                                                  std::vector<Sphere> medial_balls,
                                                  std::span<const Element> elements, double excess,
                                                  Rng& rng);

/// Chooses a small subset of `proposals` that contains all `elements`: greedy, then improved by
/// removing some spheres and covering the rest again, for up to `effort` steps of a nanosecond. A
/// piece that no proposal contains gets its own sphere. Deterministic given `rng`.
[[nodiscard]] std::vector<Sphere> choose_spheres(std::vector<Sphere> proposals,
                                                 std::span<const Element> elements,
                                                 std::int64_t effort, Rng& rng);

/// Shrinks each sphere to the pieces that need it and moves it to where it sticks out least, in
/// turns. Covered pieces stay covered; spheres that no piece needs are dropped.
[[nodiscard]] std::vector<Sphere> refine(std::vector<Sphere> spheres,
                                         std::span<const Element> elements,
                                         const SolidModel& solid);

}  // namespace mneme::internal
