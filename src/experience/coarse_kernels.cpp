// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Compiled once per instruction set.
#include "experience/coarse_kernels.h"

#include <algorithm>
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

#if HWY_TARGET == HWY_SCALAR

std::uint64_t near_keys(const CoarsePair* blocks, std::size_t block_count, std::size_t pair_count,
                        const std::int16_t* query, std::int32_t most) {
  std::uint64_t near = 0;
  for (std::size_t key = 0; key < block_count * kCoarseBlock; ++key) {
    const CoarsePair* block = blocks + key / kCoarseBlock * pair_count;
    std::int32_t squared = 0;
    for (std::size_t i = 0; i < 2 * pair_count; ++i) {
      const int apart = block[i / 2].cells[2 * (key % kCoarseBlock) + i % 2] - query[i];
      squared += apart * apart;
    }
    near |= std::uint64_t{squared <= most} << key;
  }
  return near;
}

void box_distances(const CoarsePair* blocks, std::size_t block_count, std::size_t pair_count,
                   const std::int16_t* query, std::int32_t* squared) {
  for (std::size_t block = 0; block < block_count; ++block, squared += kCoarseBlock) {
    std::fill_n(squared, kCoarseBlock, 0);
    for (std::size_t pair = 0; pair < pair_count; ++pair, blocks += 2) {
      for (std::size_t i = 0; i < 2 * kCoarseBlock; ++i) {
        const int q = query[2 * pair + i % 2];
        const int apart = std::max({0, blocks[0].cells[i] - q - 1, q - blocks[1].cells[i] - 1});
        squared[i / 2] += apart * apart;
      }
    }
  }
}

#else

// Lanes of pairs, and of their sums.
using Cells = hn::CappedTag<std::int16_t, 2 * kCoarseBlock>;
using Sums = hn::Repartition<std::int32_t, Cells>;
using CellsV = hn::Vec<Cells>;
using SumsV = hn::Vec<Sums>;
constexpr std::size_t kSumLanes = hn::MaxLanes(Sums());
constexpr std::size_t kParts = kCoarseBlock / kSumLanes;
/// Blocks that are scanned together.
constexpr std::size_t kMostBlocks = 4;

/// Both numbers of a pair of the query in each lane of a sum.
HWY_INLINE CellsV pair_of(const std::int16_t* query, std::size_t pair) {
  const hn::Repartition<std::int16_t, Sums> cells;
  std::int32_t both = 0;
  std::memcpy(&both, query + 2 * pair, sizeof both);
  return hn::BitCast(cells, hn::Set(Sums(), both));
}

HWY_INLINE SumsV add_squares(CellsV cells, SumsV total) {
#if HWY_ARCH_X86
  SumsV unused = hn::Zero(Sums());
  return hn::ReorderWidenMulAccumulate(Sums(), cells, cells, total, unused);
#else  // where that function does not add the products of neighbours
  const SumsV pairs = hn::BitCast(Sums(), cells);
  const SumsV even = hn::ShiftRight<16>(hn::ShiftLeft<16>(pairs)), odd = hn::ShiftRight<16>(pairs);
  return hn::Add(total, hn::Add(hn::Mul(even, even), hn::Mul(odd, odd)));
#endif
}

HWY_INLINE std::uint64_t bits_of(hn::Mask<Sums> mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(Sums(), mask, bytes);
  return (bytes[0] | std::uint64_t{bytes[1]} << 8) & ((1U << kSumLanes) - 1);
}

template <std::size_t kBlocks>
HWY_INLINE std::uint64_t near_keys_of(const CoarsePair* blocks, std::size_t pair_count,
                                      const std::int16_t* query, std::int32_t most) {
  SumsV totals[kBlocks * kParts];
  for (SumsV& total : totals) total = hn::Zero(Sums());
  for (std::size_t pair = 0; pair < pair_count; ++pair, ++blocks) {
    const CellsV q = pair_of(query, pair);
    for (std::size_t i = 0; i < kBlocks * kParts; ++i) {
      const std::int16_t* cells =
          blocks[i / kParts * pair_count].cells + i % kParts * 2 * kSumLanes;
      totals[i] = add_squares(hn::Sub(hn::Load(Cells(), cells), q), totals[i]);
    }
  }
  std::uint64_t near = 0;
  for (std::size_t i = 0; i < kBlocks * kParts; ++i) {
    const auto is_far = hn::Gt(totals[i], hn::Set(Sums(), most));
    near |= bits_of(hn::Not(is_far)) << (i * kSumLanes);
  }
  return near;
}

std::uint64_t near_keys(const CoarsePair* blocks, std::size_t block_count, std::size_t pair_count,
                        const std::int16_t* query, std::int32_t most) {
  switch (block_count) {
    case 0:
      return 0;
    case 1:
      return near_keys_of<1>(blocks, pair_count, query, most);
    case 2:
      return near_keys_of<2>(blocks, pair_count, query, most);
    case 3:
      return near_keys_of<3>(blocks, pair_count, query, most);
    default:
      return near_keys_of<kMostBlocks>(blocks, pair_count, query, most);
  }
}

void box_distances(const CoarsePair* blocks, std::size_t block_count, std::size_t pair_count,
                   const std::int16_t* query, std::int32_t* squared) {
  const Cells d;
  const CellsV one = hn::Set(d, 1);
  for (std::size_t block = 0; block < block_count; ++block, squared += kCoarseBlock) {
    SumsV totals[kParts];
    for (SumsV& total : totals) total = hn::Zero(Sums());
    for (std::size_t pair = 0; pair < pair_count; ++pair, blocks += 2) {
      const CellsV q = pair_of(query, pair);
      for (std::size_t part = 0; part < kParts; ++part) {
        const std::size_t first = 2 * kSumLanes * part;
        const CellsV apart = hn::Max(hn::Sub(hn::Load(d, blocks[0].cells + first), q),
                                     hn::Sub(q, hn::Load(d, blocks[1].cells + first)));
        totals[part] = add_squares(hn::Max(hn::Sub(apart, one), hn::Zero(d)), totals[part]);
      }
    }
    for (std::size_t part = 0; part < kParts; ++part) {
      hn::StoreU(totals[part], Sums(), squared + kSumLanes * part);
    }
  }
}

#endif

const CoarseKernels& kernels() {
  static const CoarseKernels table = {&near_keys, &box_distances};
  return table;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace mneme::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
MNEME_EXPORT(const CoarseKernels&, coarse_kernels, kernels)
#endif
