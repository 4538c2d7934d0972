// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Kernels for distances from one configuration to many.
#pragma once

#include "mneme/base.h"

#include "tables/tables.h"

#include <utility>

namespace mneme::internal {

/// Configurations per block. A block holds all first joints, all second joints, and so on, then
/// half of the squared norms. Empty lanes have an infinite norm, so that they are never the
/// nearest.
inline constexpr int kBlockSize = 16;
inline constexpr int kMaxJoints = kMaxFrames;

/// Half the width of a box that is never near.
inline constexpr float kNoBox = -1e18f;

/// Configurations per leaf. Smaller: more boxes; larger: more configurations compared in vain.
inline constexpr int kLeafSize = 64;

/// Leaf i has kLeafSize / kBlockSize blocks and lies in box i. Boxes are stored kBlockSize at a
/// time: their centers in the first joint, their half widths in the first joint, their centers in
/// the second joint, and so on. Unused places have the half width kNoBox.
struct LeafTable {
  const float* blocks = nullptr;
  const float* boxes = nullptr;
  int leaf_count = 0;
  int joint_count = 0;
  const float* periods = nullptr;  ///< as in NearestKernels::nearest
};

/// Squared distances are accurate to 1e-6 of the configurations' squared norms.
struct NearestKernels {
  /// Index and squared distance of the configuration nearest to `q` among the first `block_count`
  /// blocks; the lowest index among equals. `periods`: 2 pi for continuous joints, 0 for others.
  std::pair<int, float> (*nearest)(const float* blocks, int block_count, int joint_count,
                                   const float* q, const float* periods) = nullptr;
  /// All squared distances, kBlockSize per block.
  void (*distances)(const float* blocks, int block_count, int joint_count, const float* q,
                    const float* periods, float* squared_distances) = nullptr;
  /// Like `nearest`, over the leaves; any index among equals. `box_distances` is scratch space, one
  /// value per place for a box.
  std::pair<int, float> (*nearest_in_leaves)(const LeafTable& leaves, const float* q,
                                             float* box_distances) = nullptr;
};

[[nodiscard]] const NearestKernels& nearest_kernels(Isa isa);

}  // namespace mneme::internal
