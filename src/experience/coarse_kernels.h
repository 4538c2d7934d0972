// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Vector kernels that find keys near a query, on keys rounded to integers.
#pragma once

#include "mneme/base.h"

#include <cstddef>
#include <cstdint>

namespace mneme::internal {

/// Keys in a block. Two consecutive numbers of a key are a pair. A block stores the first pair of
/// each of its keys, then the second pair of each, and so on; a missing last number is 0.
inline constexpr std::size_t kCoarseBlock = 16;
/// One pair of each key of a block; aligned to cache lines.
struct alignas(64) CoarsePair {
  std::int16_t cells[2 * kCoarseBlock] = {};
};

/// Numbers are cell indices, rounded down: values in cells that differ by n are n - 1 to n + 1 cell
/// widths apart. `query` has two cells per pair. The sum of squared cell differences over all pairs
/// must be less than 2^31.
struct CoarseKernels {
  /// Returns one bit per key of at most four blocks: set if the squared distance of its cells to
  /// the query's is at most `most`.
  std::uint64_t (*near_keys)(const CoarsePair* blocks, std::size_t block_count,
                             std::size_t pair_count, const std::int16_t* query,
                             std::int32_t most) = nullptr;
  /// Writes lower bounds of the squared distance from the query to boxes, in cells, one per box. A
  /// block stores, per pair, the lower cells of its 16 boxes, then the upper ones.
  void (*box_distances)(const CoarsePair* blocks, std::size_t block_count, std::size_t pair_count,
                        const std::int16_t* query, std::int32_t* squared) = nullptr;
};

[[nodiscard]] const CoarseKernels& coarse_kernels(Isa isa);

}  // namespace mneme::internal
