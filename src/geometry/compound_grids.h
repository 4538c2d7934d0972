// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What the kernels read of a compound shape's parts: made when it is first asked for, and kept
/// with them.
#pragma once

#include "geometry/axis_box.h"
#include "geometry/part_tree.h"
#include "geometry/point_grid.h"

#include <memory>

namespace mneme::internal {

/// Of the parts' frame, the point that the coordinates in a grid or tree are relative to.
[[nodiscard]] Vec3 middle_of(const VoxelGrid& voxels);

/// `box`, in the parts' frame, holds all that will be asked for. One that was made for a larger box
/// is as good.
[[nodiscard]] std::shared_ptr<const PointGrid> share_grid(const Parts<CloudPoint>& parts,
                                                          const AxisBox& box);
[[nodiscard]] std::shared_ptr<const PartTree> share_grid(const Parts<Triangle>& parts,
                                                         const AxisBox& box);
[[nodiscard]] std::shared_ptr<const PartTree> share_grid(const Parts<Cube>& parts,
                                                         const AxisBox& box);

}  // namespace mneme::internal
