// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Clouds, meshes and octrees in the kernels' tables.
#pragma once

#include "mneme/geometry.h"
#include "mneme/robot.h"

#include "tables/tables.h"

namespace mneme::internal {

/// Metres that are spared for margins beyond those of the checker.
inline constexpr double kSpareReach = 0.25;
/// farthest_reach(), and what is spared.
[[nodiscard]] double reach_of(const Robot& robot);

/// `compound` stands in the scene's frame. Only what is within `reach` of the origin is of
/// interest. What takes long is kept with the parts and found there again.
[[nodiscard]] CompoundRow make_compound_row(const PointCloud& compound, double reach);
[[nodiscard]] CompoundRow make_compound_row(const Mesh& compound, double reach);
[[nodiscard]] CompoundRow make_compound_row(const Octree& compound, double reach);

}  // namespace mneme::internal
