// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Which keys may be near, in whole numbers, many at a time.
#pragma once

#include "mneme/base.h"

#include <cstddef>
#include <cstdint>

namespace mneme::internal {

/// Keys in a block. A block has the first two numbers of its first key, those of its second one,
/// and so on, then the third and fourth numbers of all: two numbers are a pair. Of an odd count the
/// last pair ends with zero.
inline constexpr std::size_t kCoarseBlock = 16;
/// A pair of numbers of the keys of a block; a vector of them, which does not straddle cache lines.
struct alignas(64) CoarsePair {
  std::int16_t cells[2 * kCoarseBlock] = {};
};

/// Numbers are cells, of which each holds what is between it and the next: what lies in two of them
/// is apart by more than their difference less one, and less than it and one. `query` has two cells
/// per pair. The sum over all pairs of squared cells must be less than 2^31.
struct CoarseKernels {
  /// Of the keys of at most four blocks, a bit each: those whose cells are at most `most` from the
  /// query's, squared.
  std::uint64_t (*near_keys)(const CoarsePair* blocks, std::size_t block_count,
                             std::size_t pair_count, const std::int16_t* query,
                             std::int32_t most) = nullptr;
  /// Least squared distances of boxes, in cells, one value per box. They lie in blocks of twice as
  /// many numbers: per pair the lower cells of all, then the upper ones.
  void (*box_distances)(const CoarsePair* blocks, std::size_t block_count, std::size_t pair_count,
                        const std::int16_t* query, std::int32_t* squared) = nullptr;
};

[[nodiscard]] const CoarseKernels& coarse_kernels(Isa isa);

}  // namespace mneme::internal
