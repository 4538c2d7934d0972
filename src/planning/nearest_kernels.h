// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Distances from one configuration to many, a vector at a time.
#pragma once

#include <cstdint>
#include <utility>

#include "mneme/base.h"

namespace mneme::internal {

/// Configurations are stored in blocks of this many: all first joints, all second joints, and so
/// on, then half of their squared norms. Lanes without a configuration have an infinite norm, so
/// that they are never near.
inline constexpr int kBlockSize = 16;
/// Most joints of a configuration.
inline constexpr int kMaxJoints = 64;

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
};

[[nodiscard]] const NearestKernels& nearest_kernels(Isa isa);

}  // namespace mneme::internal
