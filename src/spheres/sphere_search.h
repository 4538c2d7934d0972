// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Set cover: chooses few of many spheres that together contain all pieces of a solid.
#pragma once

#include "mneme/base.h"

#include "spheres/solid_model.h"
#include "spheres/triangle_mesh.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
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

/// Tests spheres for one that contains a piece or point: first the sphere that did so before, as
/// neighbours follow each other.
class LatestFirst {
 public:
  template <class Contains>
  [[nodiscard]] bool any(std::span<const Sphere> spheres, const Contains& contains) {
    if (latest_ < spheres.size() && contains(spheres[latest_])) return true;
    const auto found = std::ranges::find_if(spheres, contains);
    latest_ = static_cast<std::size_t>(found - spheres.begin());
    return found != spheres.end();
  }

 private:
  std::size_t latest_ = 0;
};

/// The pieces of a solid. Spheres that contain its surface contain most of its inside, too: the
/// inner pieces are spare until spheres miss them.
struct SolidPieces {
  /// Cuts the surface and the inner voxels into pieces of about `size` metres.
  SolidPieces(const TriangleMesh& mesh, const SolidModel& solid, double size);
  explicit SolidPieces(std::vector<Element> all) : needed(std::move(all)) {}

  /// Makes spare pieces that no sphere contains needed, at the end of them. Returns their number.
  std::size_t need_bare(std::span<const Sphere> spheres);

  std::vector<Element> needed, spare;
};

/// Proposes spheres around points on the solid's medial axis and on its surface, each as large as
/// `excess` allows. Such a sphere around any other point lies within one of these. `medial_balls`
/// come from the solid.
[[nodiscard]] std::vector<Sphere> propose_spheres(const SolidModel& solid,
                                                  std::vector<Sphere> medial_balls,
                                                  std::span<const Element> elements, double excess,
                                                  Rng& rng);

/// Chooses a small subset of `proposals` that contains all pieces: greedy, then improved by
/// removing some spheres and covering the rest again, for up to `effort` steps of a nanosecond. A
/// piece that no proposal contains gets its own sphere. Spare pieces that would be missed become
/// needed. Deterministic given `rng`.
[[nodiscard]] std::vector<Sphere> choose_spheres(std::vector<Sphere> proposals, SolidPieces& pieces,
                                                 std::int64_t effort, Rng& rng);

/// Shrinks each sphere to the pieces that need it and moves it to where it sticks out least, in
/// turns. Covered pieces stay covered; spheres that no piece needs are dropped. Spare pieces that
/// would be missed become needed.
[[nodiscard]] std::vector<Sphere> refine(const std::vector<Sphere>& spheres, SolidPieces& pieces,
                                         const SolidModel& solid);

}  // namespace mneme::internal
