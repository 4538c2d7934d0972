// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The shortest vectors and distances that those to all shapes are made of.
#pragma once

#include "mneme/geometry.h"

namespace mneme::internal {

/// From the segment ab to `p`.
[[nodiscard]] Vec3 excess_of_segment(const Vec3& p, const Vec3& a, const Vec3& b);
/// From a box around the origin to `p`: zero inside.
[[nodiscard]] Vec3 excess_of_box(const Vec3& p, const Vec3& half_extents);
/// Between the segment ab and a box around the origin.
[[nodiscard]] double distance_to_box(const Vec3& a, const Vec3& b, const Vec3& half_extents);

}  // namespace mneme::internal
