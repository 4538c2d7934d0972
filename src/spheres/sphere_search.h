// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Few of many spheres that together hold all pieces of a solid: set cover.
#pragma once

#include "mneme/base.h"

#include "spheres/solid_model.h"
#include "spheres/triangle_mesh.h"

#include <cstdint>
#include <span>
#include <vector>

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

/// Pieces of about `size` metres: all of the surface, and all voxels inside.
[[nodiscard]] std::vector<Element> make_elements(const TriangleMesh& mesh, const SolidModel& solid,
                                                 double size);

/// Spheres about points on the solid's medial axis and on its surface, each as large as it may be
/// to stick out by at most `excess`: about any other point, such a sphere lies within one of these.
/// `medial_balls` are those of the solid.
[[nodiscard]] std::vector<Sphere> propose_spheres(const SolidModel& solid,
                                                  std::vector<Sphere> medial_balls,
                                                  std::span<const Element> elements, double excess,
                                                  Rng& rng);

/// A small subset of `proposals` that holds all `elements`: greedy, then improved by taking some
/// spheres away and covering what is bare again, until `effort` steps (about a nanosecond each) are
/// done. A piece that no proposal holds gets a sphere of its own. Deterministic given `rng`.
[[nodiscard]] std::vector<Sphere> choose_spheres(std::vector<Sphere> proposals,
                                                 std::span<const Element> elements,
                                                 std::int64_t effort, Rng& rng);

/// The same cover with each sphere shrunk to the pieces that need it and moved to where it sticks
/// out least, in turns. What `spheres` hold stays held; a sphere that nothing needs is dropped.
[[nodiscard]] std::vector<Sphere> refine(std::vector<Sphere> spheres,
                                         std::span<const Element> elements,
                                         const SolidModel& solid);

}  // namespace mneme::internal
