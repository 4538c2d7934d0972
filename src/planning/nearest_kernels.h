// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Distances from one configuration to many, a vector at a time.
#pragma once

#include "mneme/base.h"

#include <cstdint>
#include <utility>

namespace mneme::internal {

/// Configurations are stored in blocks of this many: all first joints, all second joints, and so
/// on, then half of their squared norms. Lanes without a configuration have an infinite norm, so
/// that they are never near.
inline constexpr int kBlockSize = 16;
/// Most joints of a configuration.
inline constexpr int kMaxJoints = 64;

/// Half the width of a box that is never near.
inline constexpr float kNoBox = -1e18f;

/// Configurations per leaf: fewer make more boxes, more are looked at in vain.
inline constexpr int kLeafSize = 64;

/// Leaf i has kLeafSize / kBlockSize blocks and lies in box i. Boxes are stored kBlockSize at a
/// time: the centers of all in the first joint, half their widths in it, the centers in the second
/// joint, and so on. Places for boxes behind the last have kNoBox for half of their widths.
struct LeafTable {
  const float* blocks = nullptr;
  const float* boxes = nullptr;
  int leaf_count = 0;
  int joint_count = 0;
  const float* periods = nullptr;  ///< as below
};

/// Squared distances are right within 1e-6 of the configurations' squared norms.
struct NearestKernels {
  /// Index and squared distance of the configuration nearest to `q` among the first `block_count`
  /// blocks; the lowest index among equals. `periods` has 2 pi for joints that wrap and 0 for the
  /// others.
  std::pair<int, float> (*nearest)(const float* blocks, int block_count, int joint_count,
                                   const float* q, const float* periods) = nullptr;
  /// All squared distances, kBlockSize per block.
  void (*distances)(const float* blocks, int block_count, int joint_count, const float* q,
                    const float* periods, float* squared_distances) = nullptr;
  /// Like `nearest`, over the leaves; any index among equals. `box_distances` is room for as many
  /// values as there are places for boxes.
  std::pair<int, float> (*nearest_in_leaves)(const LeafTable& leaves, const float* q,
                                             float* box_distances) = nullptr;
};

[[nodiscard]] const NearestKernels& nearest_kernels(Isa isa);

}  // namespace mneme::internal
