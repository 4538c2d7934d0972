// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The sphere approximation of a surface, and measures of its quality.
#pragma once

#include "mneme/spheres.h"

#include "spheres/solid_model.h"
#include "spheres/triangle_mesh.h"

#include <span>
#include <vector>

namespace mneme::internal {

/// Points on the surface, evenly by area, with a fixed seed.
[[nodiscard]] std::vector<Vec3> sample_surface(const TriangleMesh& mesh, int count);

/// Points inside between the surface and the voxels that lie inside as a whole: four of each voxel.
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

/// To be raised whenever the same surface and settings give other spheres.
inline constexpr int kSphereVersion = 2;

/// Spheres that hold `mesh`, which has an area, and what it encloses; their number and excess obey
/// the settings, where both cannot be had the number. Coordinates are multiples of 10 um.
[[nodiscard]] LinkSpheres approximate_solid(const TriangleMesh& mesh,
                                            const SphereSettings& settings);

}  // namespace mneme::internal
