// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Whole scenes of circles in canonical form, and as images: what methods without local primitives
/// are conditioned on.
#pragma once

#include "mneme/memory.h"

#include <vector>

namespace mneme::internal {

/// The spheres of a scene as circles: x, y, radius of each, metres.
[[nodiscard]] PrimitiveKey circles_of(const Scene& scene);

/// Direction of the mean centre, seen from the base; 0 for no circles. A scene that is turned by
/// the opposite angle is canonical.
[[nodiscard]] double mean_direction(const PrimitiveKey& circles);

/// `cells` x `cells` values, rows of constant y, over a square of twice `half_extent` metres around
/// the base: 1 inside of circles, 0 outside, and between where a cell lies on a boundary.
[[nodiscard]] std::vector<float> draw_image(const PrimitiveKey& circles, int cells,
                                            double half_extent);

}  // namespace mneme::internal
