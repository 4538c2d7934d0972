// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Bounds of squared distances of keys in whole numbers, many at a time.
#pragma once

#include "mneme/base.h"

#include <cstddef>
#include <cstdint>

namespace mneme::internal {

/// Keys in a block. A block has the first two numbers of its first key, those of its second one,
/// and so on, then the third and fourth numbers of all: two numbers are a pair. Of an odd count the
/// last pair ends with zero.
inline constexpr std::size_t kCoarseBlock = 16;

/// Numbers are cells, of which each holds what is between it and the next: what lies in two of them
/// is apart by more than their difference less one. `query` has two cells per pair. The sum over
/// all pairs of squared cells must be less than 2^31. One value per key.
struct CoarseKernels {
  /// Least squared distances, in cells, of the keys of `block_count` blocks.
  void (*key_distances)(const std::int16_t* blocks, std::size_t block_count, std::size_t pair_count,
                        const std::int16_t* query, std::int32_t* squared) = nullptr;
  /// Likewise of boxes, which lie in blocks of twice as many numbers: per pair the lower cells of
  /// all, then the upper ones.
  void (*box_distances)(const std::int16_t* blocks, std::size_t block_count, std::size_t pair_count,
                        const std::int16_t* query, std::int32_t* squared) = nullptr;
};

[[nodiscard]] const CoarseKernels& coarse_kernels(Isa isa);

}  // namespace mneme::internal
