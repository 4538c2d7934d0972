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

/// The query, one vector per joint, and the joints in the order in which they are summed.
class Query {
 public:
  HWY_INLINE Query(int joint_count, const float* q, const float* periods)
      : joint_count_(joint_count) {
    for (int j = 0; j < joint_count; ++j) {
      values_[j] = splat(q[j]);
      if (periods[j] > 0) wrapped_[wrapped_count_++] = {j, periods[j]};
    }
  }

  /// Squared distances of the configurations at `column`, one per lane. With `kJoints` > 0 that is
  /// the number of joints, so that the loop unrolls and the query stays in registers.
  template <int kJoints>
  HWY_INLINE V squared_distance(const float* column) const {
    const Tag d;
    const int joint_count = kJoints > 0 ? kJoints : joint_count_;
    V sum = hn::Zero(d);
    for (int j = 0; j < joint_count; ++j) {
      const V difference = hn::Sub(hn::LoadU(d, column + j * kBlockSize), values_[j]);
      sum = hn::MulAdd(difference, difference, sum);
    }
    // Exchanges the squares of the joints that wrap, of which most robots have few.
    for (int i = 0; i < wrapped_count_; ++i) {
      const auto [j, period] = wrapped_[i];
      const V difference = hn::Sub(hn::LoadU(d, column + j * kBlockSize), values_[j]);
      const V turns = hn::Round(hn::Mul(difference, splat(1.0f / period)));
      const V shorter = hn::NegMulAdd(turns, splat(period), difference);
      sum = hn::NegMulAdd(difference, difference, sum);
      sum = hn::MulAdd(shorter, shorter, sum);
    }
    // What was exchanged may leave a rounding error below zero.
    return hn::Max(sum, hn::Zero(d));
  }

 private:
  struct Wrapped {
    int joint;
    float period;
  };
  int joint_count_;
  int wrapped_count_ = 0;
  V values_[kMaxJoints];
  Wrapped wrapped_[kMaxJoints];
};

template <int kJoints>
std::pair<int, float> nearest_of(const float* blocks, int block_count, int joint_count,
                                 const Query& query) {
  const Tag d;
  const hn::RebindToSigned<Tag> di;
  const int lanes = static_cast<int>(hn::Lanes(d));
  V least = splat(std::numeric_limits<float>::infinity());
  auto least_base = hn::Zero(di);
  for (int block = 0; block < block_count; ++block, blocks += kBlockSize * joint_count) {
    for (int offset = 0; offset < kBlockSize; offset += lanes) {
      const V sum = query.squared_distance<kJoints>(blocks + offset);
      const M is_less = hn::Lt(sum, least);
      least = hn::IfThenElse(is_less, sum, least);
      least_base = hn::IfThenElse(hn::RebindMask(di, is_less),
                                  hn::Set(di, block * kBlockSize + offset), least_base);
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

std::pair<int, float> nearest(const float* blocks, int block_count, int joint_count, const float* q,
                              const float* periods) {
  const Query query(joint_count, q, periods);
  switch (joint_count) {
    case 6:
      return nearest_of<6>(blocks, block_count, joint_count, query);
    case 7:
      return nearest_of<7>(blocks, block_count, joint_count, query);
    case 8:
      return nearest_of<8>(blocks, block_count, joint_count, query);
    default:
      return nearest_of<0>(blocks, block_count, joint_count, query);
  }
}

void distances(const float* blocks, int block_count, int joint_count, const float* q,
               const float* periods, float* squared_distances) {
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const Query query(joint_count, q, periods);
  for (int block = 0; block < block_count; ++block, blocks += kBlockSize * joint_count) {
    for (int offset = 0; offset < kBlockSize; offset += lanes) {
      hn::StoreU(query.squared_distance<0>(blocks + offset), d,
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
