// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The points of a cloud sorted into voxels, as the kernels read them; they may be replaced.
#pragma once

#include "geometry/voxel_grid.h"

#include <memory>
#include <span>

namespace mneme::internal {

inline constexpr int kPointsPerBlock = 8;

/// Points of one voxel; where there is none, coordinates are infinite.
struct PointBlock {
  float x[kPointsPerBlock], y[kPointsPerBlock], z[kPointsPerBlock];
  int next = -1;  ///< block of the same voxel
};

struct PointGrid {
  std::shared_ptr<std::pmr::memory_resource> pages;  ///< of what follows, unless it was copied
  VoxelGrid voxels;
  std::pmr::vector<int> first_block;  ///< per voxel; -1 if it is empty
  std::pmr::vector<PointBlock> blocks;
  Region region{};           ///< points outside of it are left out
  std::size_t size = 0;      ///< points at first
  std::size_t replaced = 0;  ///< points since
};

using PointSpan = std::span<const std::array<float, 3>>;

/// Points outside of `region`, which is relative to `middle`, are left out.
[[nodiscard]] PointGrid make_point_grid(PointSpan points, const Region& region,
                                        const Middle& middle = {});

/// Takes out what stands at `before`, and puts in `after`. False if the grid must be made anew:
/// something lies outside of the voxels though within the region, or so much has been replaced that
/// what is left of it would be slow.
[[nodiscard]] bool replace_points(PointSpan before, PointSpan after, PointGrid& grid);

}  // namespace mneme::internal
