// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Compiled once per instruction set.
#include "planning/nearest_kernels.h"

#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "planning/nearest_kernels.cpp"
#include "hwy/foreach_target.h"

#include "simd/dispatch.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mneme::internal {
namespace HWY_NAMESPACE {
namespace {

/// Squared distances of the configurations at `column`, one per lane.
HWY_INLINE V squared_distance(const float* column, int joint_count, const float* q, const float* periods) {
  const Tag d;
  V sum = hn::Zero(d);
  for (int j = 0; j < joint_count; ++j, column += kBlockSize) {
    V difference = hn::Sub(hn::LoadU(d, column), splat(q[j]));
    if (periods[j] > 0) {
      const V turns = hn::Round(hn::Mul(difference, splat(1.0f / periods[j])));
      difference = hn::NegMulAdd(turns, splat(periods[j]), difference);
    }
    sum = hn::MulAdd(difference, difference, sum);
  }
  return sum;
}

std::pair<int, float> nearest(const float* blocks, int block_count, int joint_count, const float* q,
                              const float* periods) {
  const Tag d;
  const hn::RebindToSigned<Tag> di;
  const int lanes = static_cast<int>(hn::Lanes(d));
  V least = splat(std::numeric_limits<float>::infinity());
  auto least_base = hn::Zero(di);
  for (int block = 0; block < block_count; ++block, blocks += kBlockSize * joint_count) {
    for (int offset = 0; offset < kBlockSize; offset += lanes) {
      const V sum = squared_distance(blocks + offset, joint_count, q, periods);
      const M is_less = hn::Lt(sum, least);
      least = hn::IfThenElse(is_less, sum, least);
      least_base = hn::IfThenElse(hn::RebindMask(di, is_less), hn::Set(di, block * kBlockSize + offset), least_base);
    }
  }
  HWY_ALIGN float distance[HWY_MAX_BYTES / sizeof(float)];
  HWY_ALIGN std::int32_t base[HWY_MAX_BYTES / sizeof(float)];
  hn::Store(least, d, distance);
  hn::Store(least_base, di, base);
  std::pair<int, float> best = {base[0], distance[0]};
  for (int lane = 1; lane < lanes; ++lane) {
    const int index = base[lane] + lane;
    if (distance[lane] < best.second || (distance[lane] == best.second && index < best.first)) {
      best = {index, distance[lane]};
    }
  }
  return best;
}

void distances(const float* blocks, int block_count, int joint_count, const float* q, const float* periods,
               float* squared_distances) {
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int block = 0; block < block_count; ++block, blocks += kBlockSize * joint_count) {
    for (int offset = 0; offset < kBlockSize; offset += lanes) {
      hn::StoreU(squared_distance(blocks + offset, joint_count, q, periods), d,
                 squared_distances + block * kBlockSize + offset);
    }
  }
}

const NearestKernels* kernels() {
  static const NearestKernels table = {&nearest, &distances};
  return &table;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace mneme::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace mneme::internal {

HWY_EXPORT(kernels);

const NearestKernels& nearest_kernels(Isa isa) { return *MNEME_DISPATCH(kernels, isa); }

}  // namespace mneme::internal
#endif  // HWY_ONCE
