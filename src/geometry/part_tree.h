// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Triangles or cubes as the kernels read them: a tree of boxes whose leaves are vectors.
#pragma once

#include "geometry/voxel_grid.h"

#include <vector>

namespace mneme::internal {

/// Parts of a leaf: the lanes of the widest vector.
inline constexpr int kPartsPerLeaf = 16;

struct PartNode {
  float low[3] = {}, high[3] = {};
  int leaf = -1;   ///< index of its block; -1 if it has children
  int right = -1;  ///< the left child follows its parent
};

/// The last triangles of a block may repeat.
struct TriangleBlock {
  float a[3][kPartsPerLeaf];
  float to_b[3][kPartsPerLeaf], to_c[3][kPartsPerLeaf];
  float normal[3][kPartsPerLeaf];  ///< normal_of(), which single precision would turn of thin ones
};

struct CubeBlock {
  float center[3][kPartsPerLeaf];
  float half_extent[kPartsPerLeaf];
};

/// Relative to the middle of the voxels.
struct PartTree {
  VoxelGrid voxels;
  Region region;  ///< parts outside of it are left out of the voxels
  std::vector<PartNode> nodes;
  std::vector<TriangleBlock> triangles;  ///< either these
  std::vector<CubeBlock> cubes;          ///< or these
};

}  // namespace mneme::internal
