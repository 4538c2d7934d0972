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

}  // namespace mneme::internal
