// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Whole scenes of circles in canonical form and as images, for methods without local primitives.
#pragma once

#include "mneme/memory.h"

#include <vector>

namespace mneme::internal {

/// The spheres of a scene as circles: x, y, radius, metres.
[[nodiscard]] PrimitiveKey circles_of(const Scene& scene);

/// Direction of the mean centre from the base, radians; 0 without circles. In canonical form it is
/// 0.
[[nodiscard]] double mean_direction(const PrimitiveKey& circles);

/// An image of `cells` x `cells` values, rows of constant y, of a square with a side of twice
/// `half_extent` metres around the base: 1 inside circles, 0 outside, values between on boundaries.
/// Cost: O(cells^2), and a square root for each cell in or near a circle.
[[nodiscard]] std::vector<float> draw_image(const PrimitiveKey& circles, int cells,
                                            double half_extent);

}  // namespace mneme::internal
