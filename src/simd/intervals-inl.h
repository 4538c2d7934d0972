// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Intervals of motions that are checked by halving, one per lane. Included once per target.
#if defined(MNEME_SIMD_INTERVALS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MNEME_SIMD_INTERVALS_INL_H_
#undef MNEME_SIMD_INTERVALS_INL_H_
#else
#define MNEME_SIMD_INTERVALS_INL_H_
#endif

#include <algorithm>
#include <cassert>
#include <cstdint>

#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mneme::internal {
namespace HWY_NAMESPACE {

/// Intervals of motions, one per lane.
struct Intervals {
  HWY_ALIGN std::int32_t motions[kLanes];
  HWY_ALIGN float middles[kLanes];
  HWY_ALIGN float halves[kLanes];
};

/// Intervals of motions that are still to be checked, depth first.
class IntervalStack {
 public:
  /// Cuts each of `motions` into `intervals`; a single one into as many as fill vectors.
  HWY_INLINE IntervalStack(int motions, int intervals)
      : count_(motions * intervals),
        blocks_((count_ + kLanes - 1) / kLanes),
        of_each_(motions == 1 ? blocks_ * kLanes : intervals) {
    if (motions == 1) count_ = of_each_;
  }

  /// Writes up to kLanes intervals and returns their number. Further lanes repeat the last.
  HWY_INLINE int pop(Intervals& popped) {
    if (size_ < kLanes && block_ < blocks_) push_block();
    const int count = std::min(size_, kLanes);
    size_ -= count;
    for (int lane = 0; lane < kLanes; ++lane) {
      const int i = size_ + std::min(lane, count - 1);
      popped.motions[lane] = motions_[i];
      popped.middles[lane] = middles_[i];
      popped.halves[lane] = halves_[i];
    }
    return count;
  }
  [[nodiscard]] HWY_INLINE bool is_empty() const { return size_ == 0 && block_ == blocks_; }
  HWY_INLINE void push(std::int32_t motion, float middle, float half) {
    assert(size_ < (kMostLevels + 2) * kLanes);
    motions_[size_] = motion;
    middles_[size_] = middle;
    halves_[size_++] = half;
  }

 private:
  /// Each level of halving leaves kLanes intervals at most.
  static constexpr int kMostLevels = 32;

  /// The first vector is spread over all motions, its last lane at the far end, where they are
  /// blocked most often. The rest goes from one end to the other.
  HWY_INLINE void push_block() {
    const float half = 0.5f / static_cast<float>(of_each_);
    for (int lane = 0; lane < kLanes; ++lane) {
      const int rank = (block_ - 1) * kLanes + lane;
      const int part = block_ == 0 ? (lane + 1) * blocks_ - 1 : rank + rank / (blocks_ - 1);
      if (part >= count_) continue;
      push(part / of_each_, static_cast<float>(2 * (part % of_each_) + 1) * half, half);
    }
    ++block_;
  }

  int count_;  ///< of intervals that are checked first
  int blocks_;
  int of_each_;  ///< intervals of each motion
  int block_ = 0;
  int size_ = 0;
  std::int32_t motions_[(kMostLevels + 2) * kLanes];
  float middles_[(kMostLevels + 2) * kLanes], halves_[(kMostLevels + 2) * kLanes];
};

}  // namespace HWY_NAMESPACE
}  // namespace mneme::internal
HWY_AFTER_NAMESPACE();

#endif  // MNEME_SIMD_INTERVALS_INL_H_
