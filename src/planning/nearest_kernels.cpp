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

/// The query, one vector per joint, and which joints wrap.
class Query {
 public:
  HWY_INLINE Query(int joint_count, const float* q, const float* periods)
      : joint_count_(joint_count) {
    float sum = 0;
    for (int j = 0; j < joint_count; ++j) {
      values_[j] = splat(q[j]);
      sum += q[j] * q[j];
      if (periods[j] > 0) wrapped_[wrapped_count_++] = {j, periods[j]};
    }
    half_norm_ = 0.5f * sum;
  }

  /// Half the squared distances of the configurations at `column`, one per lane, less that of the
  /// query from zero: |x|^2 / 2 - q x takes half the instructions of |x - q|^2. With `kJoints` > 0
  /// that is the number of joints, so that the loop unrolls and the query stays in registers.
  template <int kJoints>
  HWY_INLINE V score(const float* column) const {
    const Tag d;
    const int joint_count = kJoints > 0 ? kJoints : joint_count_;
    V score = hn::LoadU(d, column + joint_count * kBlockSize);
    for (int j = 0; j < joint_count; ++j) {
      score = hn::NegMulAdd(hn::LoadU(d, column + j * kBlockSize), values_[j], score);
    }
    // Exchanges the squares of the joints that wrap, of which most robots have few.
    for (int i = 0; i < wrapped_count_; ++i) {
      const auto [j, period] = wrapped_[i];
      const V difference = hn::Sub(hn::LoadU(d, column + j * kBlockSize), values_[j]);
      const V turns = hn::Round(hn::Mul(difference, splat(1.0f / period)));
      const V shorter = hn::NegMulAdd(turns, splat(period), difference);
      const V change = hn::MulSub(shorter, shorter, hn::Mul(difference, difference));
      score = hn::MulAdd(splat(0.5f), change, score);
    }
    return score;
  }

  /// The squared distance that belongs to a score; rounding may leave it just below zero.
  HWY_INLINE V squared_distance(V score) const {
    const V half = hn::Max(hn::Add(score, splat(half_norm_)), hn::Zero(Tag()));
    return hn::Add(half, half);
  }

 private:
  struct Wrapped {
    int joint;
    float period;
  };
  int joint_count_;
  int wrapped_count_ = 0;
  float half_norm_;
  V values_[kMaxJoints];
  Wrapped wrapped_[kMaxJoints];
};

template <int kJoints>
std::pair<int, float> nearest_of(const float* blocks, int block_count, int joint_count,
                                 const Query& query) {
  const Tag d;
  const hn::RebindToSigned<Tag> di;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int stride = kBlockSize * (joint_count + 1);
  V least = splat(std::numeric_limits<float>::infinity());
  auto least_base = hn::Zero(di);
  for (int block = 0; block < block_count; ++block, blocks += stride) {
    for (int offset = 0; offset < kBlockSize; offset += lanes) {
      const V score = query.score<kJoints>(blocks + offset);
      const M is_less = hn::Lt(score, least);
      least = hn::IfThenElse(is_less, score, least);
      least_base = hn::IfThenElse(hn::RebindMask(di, is_less),
                                  hn::Set(di, block * kBlockSize + offset), least_base);
    }
  }
  const V least_of_all = hn::MinOfLanes(d, least);
  const auto index = hn::Add(least_base, hn::Iota(di, 0));
  const auto candidates = hn::IfThenElse(hn::RebindMask(di, hn::Eq(least, least_of_all)), index,
                                         hn::Set(di, std::numeric_limits<std::int32_t>::max()));
  return {hn::GetLane(hn::MinOfLanes(di, candidates)),
          hn::GetLane(query.squared_distance(least_of_all))};
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
  const int stride = kBlockSize * (joint_count + 1);
  const Query query(joint_count, q, periods);
  for (int block = 0; block < block_count; ++block, blocks += stride) {
    for (int offset = 0; offset < kBlockSize; offset += lanes) {
      hn::StoreU(query.squared_distance(query.score<0>(blocks + offset)), d,
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
