// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Compiled once per instruction set.
#include "experience/coarse_kernels.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "experience/coarse_kernels.cpp"
#include "hwy/foreach_target.h"

#include "simd/dispatch.h"

#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace mneme::internal {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kBlockNumbers = 2 * kCoarseBlock;

#if HWY_TARGET == HWY_SCALAR

/// `apart` gives how far one number of a pair is from the query's, in cells.
template <std::size_t kArrays, class Apart>
void distances(const std::int16_t* blocks, std::size_t block_count, std::size_t pair_count,
               const std::int16_t* query, std::int32_t* squared, const Apart& apart) {
  for (std::size_t block = 0; block < block_count; ++block, squared += kCoarseBlock) {
    std::fill_n(squared, kCoarseBlock, 0);
    for (std::size_t pair = 0; pair < pair_count; ++pair, blocks += kArrays * kBlockNumbers) {
      for (std::size_t i = 0; i < kBlockNumbers; ++i) {
        const int least = std::max(0, apart(blocks + i, query[2 * pair + i % 2]) - 1);
        squared[i / 2] += least * least;
      }
    }
  }
}

void key_distances(const std::int16_t* blocks, std::size_t block_count, std::size_t pair_count,
                   const std::int16_t* query, std::int32_t* squared) {
  distances<1>(blocks, block_count, pair_count, query, squared,
               [](const std::int16_t* cell, int q) { return std::abs(*cell - q); });
}

void box_distances(const std::int16_t* blocks, std::size_t block_count, std::size_t pair_count,
                   const std::int16_t* query, std::int32_t* squared) {
  distances<2>(blocks, block_count, pair_count, query, squared,
               [](const std::int16_t* lower, int q) {
                 return std::max(*lower - q, q - lower[kBlockNumbers]);
               });
}

#else

// Lanes of pairs, and of their sums.
using Cells = hn::CappedTag<std::int16_t, kBlockNumbers>;
using Sums = hn::Repartition<std::int32_t, Cells>;
using CellsV = hn::Vec<Cells>;

/// Both numbers of a pair of the query in each lane of a sum.
HWY_INLINE CellsV pair_of(const std::int16_t* query, std::size_t pair) {
  const hn::Repartition<std::int16_t, Sums> cells;
  std::int32_t both = 0;
  std::memcpy(&both, query + 2 * pair, sizeof both);
  return hn::BitCast(cells, hn::Set(Sums(), both));
}

/// `apart` gives how far the numbers at an offset of a pair's are from the query's, in cells.
template <std::size_t kArrays, class Apart>
HWY_INLINE void distances(const std::int16_t* blocks, std::size_t block_count,
                          std::size_t pair_count, const std::int16_t* query, std::int32_t* squared,
                          const Apart& apart) {
  const Cells d;
  const Sums sums;
  constexpr std::size_t kLanes = hn::MaxLanes(Sums());
  constexpr std::size_t kParts = kCoarseBlock / kLanes;
  const CellsV one = hn::Set(d, 1);
  for (std::size_t block = 0; block < block_count; ++block, squared += kCoarseBlock) {
    hn::Vec<Sums> totals[kParts];
    for (auto& total : totals) total = hn::Zero(sums);
    for (std::size_t pair = 0; pair < pair_count; ++pair, blocks += kArrays * kBlockNumbers) {
      const CellsV q = pair_of(query, pair);
      for (std::size_t part = 0; part < kParts; ++part) {
        const CellsV least =
            hn::Max(hn::Sub(apart(blocks + 2 * kLanes * part, q), one), hn::Zero(d));
        hn::Vec<Sums> unused = hn::Zero(sums);
        totals[part] = hn::ReorderWidenMulAccumulate(sums, least, least, totals[part], unused);
      }
    }
    for (std::size_t part = 0; part < kParts; ++part) {
      hn::StoreU(totals[part], sums, squared + kLanes * part);
    }
  }
}

void key_distances(const std::int16_t* blocks, std::size_t block_count, std::size_t pair_count,
                   const std::int16_t* query, std::int32_t* squared) {
  distances<1>(blocks, block_count, pair_count, query, squared,
               [](const std::int16_t* cells, CellsV q) {
                 return hn::Abs(hn::Sub(hn::LoadU(Cells(), cells), q));
               });
}

void box_distances(const std::int16_t* blocks, std::size_t block_count, std::size_t pair_count,
                   const std::int16_t* query, std::int32_t* squared) {
  distances<2>(blocks, block_count, pair_count, query, squared,
               [](const std::int16_t* lower, CellsV q) {
                 const Cells d;
                 return hn::Max(hn::Sub(hn::LoadU(d, lower), q),
                                hn::Sub(q, hn::LoadU(d, lower + kBlockNumbers)));
               });
}

#endif

const CoarseKernels* kernels() {
  static const CoarseKernels table = {&key_distances, &box_distances};
  return &table;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace mneme::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace mneme::internal {

HWY_EXPORT(kernels);

const CoarseKernels& coarse_kernels(Isa isa) { return *MNEME_DISPATCH(kernels, isa); }

}  // namespace mneme::internal
#endif  // HWY_ONCE
