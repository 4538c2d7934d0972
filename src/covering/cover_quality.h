// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// How well spheres cover a solid: measured by samples that the search did not use.
#pragma once

#include <span>
#include <vector>

#include "covering/solid_model.h"

namespace mneme::internal {

/// Points on the surface, evenly by area, with a fixed seed.
[[nodiscard]] std::vector<Vec3> sample_surface(const TriangleMesh& mesh, int count);

/// Points inside between the surface and the cells that lie inside as a whole: four of each cell.
[[nodiscard]] std::vector<Vec3> sample_near_surface(const SolidModel& solid);

/// The fraction of `points` that no sphere holds.
[[nodiscard]] double uncovered_fraction(std::span<const Vec3> points,
                                        std::span<const Sphere> spheres);

/// How far the skin of the spheres' union is outside the solid, metres; 0 where it is inside.
struct Excess {
  double mean = 0;
  double max = 0;
};
[[nodiscard]] Excess measure_excess(std::span<const Sphere> spheres, const SolidModel& solid);

}  // namespace mneme::internal
