// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The covering algorithm, from a surface to spheres.
#pragma once

#include "mneme/covering.h"

#include "covering/triangle_mesh.h"

namespace mneme::internal {

/// To be raised whenever the same surface and settings give other spheres.
inline constexpr int kCoverVersion = 1;

/// Spheres that cover `mesh`, which has an area, and what it encloses; their number and excess obey
/// the settings, where both cannot be had the number. Coordinates are multiples of 10 um.
[[nodiscard]] LinkCover cover_solid(const TriangleMesh& mesh, const CoverSettings& settings);

}  // namespace mneme::internal
