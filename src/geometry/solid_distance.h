// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Distances from what a surface encloses.
#pragma once

#include "mneme/geometry.h"

namespace mneme::internal {

/// Metres between a shape and a surface, without its radius, with all that it encloses: 0 if they
/// meet, and where lines do not show that each part of the shape is outside. A shape that is itself
/// a mesh counts as its surface. Exact, from a cylinder to within 1e-9 m.
[[nodiscard]] double distance_to_solid(const Mesh& surface, const Shape& shape);

/// Metres between two surfaces, without their radii, with all that each encloses: as
/// distance_to_solid, exact if that is less than `enough`, which is above 0, and otherwise anything
/// from `enough` on.
[[nodiscard]] double distance_between_solids(const Mesh& a, const Mesh& b, double enough);

}  // namespace mneme::internal
