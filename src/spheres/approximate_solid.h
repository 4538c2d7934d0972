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

/// Samples points on the surface, uniform by area, with a fixed seed.
[[nodiscard]] std::vector<Vec3> sample_surface(const TriangleMesh& mesh, int count);

/// Returns points inside the solid in voxels that the surface runs through, up to four per voxel,
/// that no sphere contains.
[[nodiscard]] std::vector<Vec3> sample_near_surface(const SolidModel& solid,
                                                    std::span<const Sphere> spheres);

/// Returns the fraction of `points` outside all spheres.
[[nodiscard]] double uncovered_fraction(std::span<const Vec3> points,
                                        std::span<const Sphere> spheres);

/// Distance of the surface of the spheres' union outside the solid, metres; 0 where it is inside.
struct Excess {
  double mean = 0;
  double max = 0;
};
[[nodiscard]] Excess measure_excess(std::span<const Sphere> spheres, const SolidModel& solid);

/// Raise it whenever the same surface and settings give other spheres: it is part of cache keys.
inline constexpr int kSphereVersion = 6;

/// Computes a capsule, or spheres, that contain `mesh`, which has an area, and what it encloses.
/// Number and excess of the spheres obey the settings; if they cannot both, the number does.
/// Coordinates of spheres are multiples of 10 um.
[[nodiscard]] LinkSpheres approximate_solid(const TriangleMesh& mesh,
                                            const SphereSettings& settings);

}  // namespace mneme::internal
