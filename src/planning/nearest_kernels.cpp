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

/// The query, one vector per joint.
class Query {
 public:
  HWY_INLINE Query(int joint_count, const float* q, const float* periods)
      : joint_count_(joint_count), periods_(periods) {
    float sum = 0;
    for (int j = 0; j < joint_count; ++j) {
      values_[j] = splat(q[j]);
      sum += q[j] * q[j];
      if (periods[j] > 0) wrapped_[wrapped_count_++] = {j, periods[j]};
    }
    half_norm_ = 0.5f * sum;
  }

  /// Returns |x|^2 / 2 - q x of the configurations x at `column`, one per lane: it orders them like
  /// |x - q|^2 in half the instructions. With `kJoints` > 0, the number of joints, the loop unrolls
  /// and the query stays in registers.
  template <int kJoints>
  HWY_INLINE V score(const float* column) const {
    const Tag d;
    const int joint_count = kJoints > 0 ? kJoints : joint_count_;
    V score = hn::LoadU(d, column + joint_count * kBlockSize);
    for (int j = 0; j < joint_count; ++j) {
      score = hn::NegMulAdd(hn::LoadU(d, column + j * kBlockSize), values_[j], score);
    }
    // Corrects the squares of continuous joints, of which most robots have few.
    for (int i = 0; i < wrapped_count_; ++i) {
      const auto [j, period] = wrapped_[i];
      const V difference = hn::Sub(hn::LoadU(d, column + j * kBlockSize), values_[j]);
      const V shorter = shortest(difference, period);
      const V change = hn::MulSub(shorter, shorter, hn::Mul(difference, difference));
      score = hn::MulAdd(splat(0.5f), change, score);
    }
    return score;
  }

  /// Squared distances from the boxes at `column`, one per lane.
  template <int kJoints>
  HWY_INLINE V squared_distance_to_boxes(const float* column) const {
    const Tag d;
    const int joint_count = kJoints > 0 ? kJoints : joint_count_;
    V sum = hn::Zero(d);
    for (int j = 0; j < joint_count; ++j, column += 2 * kBlockSize) {
      const V difference = shortest(hn::Sub(hn::LoadU(d, column), values_[j]), periods_[j]);
      const V beyond = hn::Sub(hn::Abs(difference), hn::LoadU(d, column + kBlockSize));
      const V outside = hn::Max(beyond, hn::Zero(d));
      sum = hn::MulAdd(outside, outside, sum);
    }
    return sum;
  }

  /// The squared distance of a score. Rounding may leave it just below zero.
  HWY_INLINE V squared_distance(V score) const {
    const V half = hn::Max(hn::Add(score, splat(half_norm_)), hn::Zero(Tag()));
    return hn::Add(half, half);
  }

 private:
  static HWY_INLINE V shortest(V difference, float period) {
    if (period == 0) return difference;
    const V turns = hn::Round(hn::Mul(difference, splat(1.0f / period)));
    return hn::NegMulAdd(turns, splat(period), difference);
  }

  struct Wrapped {
    int joint;
    float period;
  };
  int joint_count_;
  const float* periods_;
  int wrapped_count_ = 0;
  float half_norm_;
  V values_[kMaxJoints];
  Wrapped wrapped_[kMaxJoints];
};

/// The least score and its index, in each lane.
class Least {
  using TagOfIndex = hn::RebindToSigned<Tag>;

 public:
  // A default member initialiser would be compiled for the baseline instruction set.
  HWY_INLINE Least()
      : score_(splat(std::numeric_limits<float>::infinity())), base_(hn::Zero(TagOfIndex())) {}

  /// `index` belongs to the first lane.
  HWY_INLINE void take(V score, int index) {
    const TagOfIndex di;
    const M is_less = hn::Lt(score, score_);
    score_ = hn::IfThenElse(is_less, score, score_);
    base_ = hn::IfThenElse(hn::RebindMask(di, is_less), hn::Set(di, index), base_);
  }

  template <int kJoints>
  HWY_INLINE void compare(const Query& query, const float* block, int index) {
    for (int offset = 0; offset < kBlockSize; offset += kLanes) {
      take(query.score<kJoints>(block + offset), index + offset);
    }
  }

  HWY_INLINE V score() const { return hn::MinOfLanes(Tag(), score_); }

  /// The lowest of the indices with the least score.
  HWY_INLINE int index() const {
    const TagOfIndex di;
    const auto candidates =
        hn::IfThenElse(hn::RebindMask(di, hn::Eq(score_, score())), hn::Add(base_, hn::Iota(di, 0)),
                       hn::Set(di, std::numeric_limits<std::int32_t>::max()));
    return hn::GetLane(hn::MinOfLanes(di, candidates));
  }

 private:
  V score_;
  hn::Vec<TagOfIndex> base_;
};

template <int kJoints>
std::pair<int, float> nearest_of(const float* blocks, int block_count, int joint_count,
                                 const Query& query) {
  const int stride = kBlockSize * (joint_count + 1);
  Least least;
  for (int block = 0; block < block_count; ++block, blocks += stride) {
    least.compare<kJoints>(query, blocks, block * kBlockSize);
  }
  return {least.index(), hn::GetLane(query.squared_distance(least.score()))};
}

template <int kJoints>
std::pair<int, float> nearest_in_leaves_of(const LeafTable& leaves, const Query& query,
                                           float* box_distances) {
  const Tag d;
  const int stride = kBlockSize * (leaves.joint_count + 1);
  Least nearest_box, least;
  const float* boxes = leaves.boxes;
  for (int leaf = 0; leaf < leaves.leaf_count; leaf += kBlockSize) {
    for (int offset = 0; offset < kBlockSize; offset += kLanes) {
      const V distance = query.squared_distance_to_boxes<kJoints>(boxes + offset);
      hn::StoreU(distance, d, box_distances + leaf + offset);
      nearest_box.take(distance, leaf + offset);
    }
    boxes += 2 * kBlockSize * leaves.joint_count;
  }
  const auto compare = [&](int leaf) {
    const float* block = leaves.blocks + leaf * (kLeafSize / kBlockSize) * stride;
    for (int i = 0; i < kLeafSize; i += kBlockSize, block += stride) {
      least.compare<kJoints>(query, block, leaf * kLeafSize + i);
    }
    return query.squared_distance(least.score());
  };
  const int first = nearest_box.index();
  V bound = compare(first);
  box_distances[first] = std::numeric_limits<float>::infinity();
  for (int begin = 0; begin < leaves.leaf_count; begin += kLanes) {
    for (;;) {
      const M is_near = hn::Lt(hn::LoadU(d, box_distances + begin), bound);
      const auto lane = hn::FindFirstTrue(d, is_near);
      if (lane < 0) break;
      const int leaf = begin + static_cast<int>(lane);
      box_distances[leaf] = std::numeric_limits<float>::infinity();
      bound = compare(leaf);
    }
  }
  return {least.index(), hn::GetLane(bound)};
}

/// Calls `function` with the number of joints as a constant for common arms, otherwise with 0.
template <class Function>
auto with_joints(int joint_count, const Function& function) {
  switch (joint_count) {
    case 6:
      return function(std::integral_constant<int, 6>());
    case 7:
      return function(std::integral_constant<int, 7>());
    case 8:
      return function(std::integral_constant<int, 8>());
    default:
      return function(std::integral_constant<int, 0>());
  }
}

std::pair<int, float> nearest(const float* blocks, int block_count, int joint_count, const float* q,
                              const float* periods) {
  const Query query(joint_count, q, periods);
  return with_joints(joint_count, [&](auto joints) {
    return nearest_of<decltype(joints)::value>(blocks, block_count, joint_count, query);
  });
}

std::pair<int, float> nearest_in_leaves(const LeafTable& leaves, const float* q,
                                        float* box_distances) {
  const Query query(leaves.joint_count, q, leaves.periods);
  return with_joints(leaves.joint_count, [&](auto joints) {
    return nearest_in_leaves_of<decltype(joints)::value>(leaves, query, box_distances);
  });
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

const NearestKernels& kernels() {
  static const NearestKernels table = {&nearest, &distances, &nearest_in_leaves};
  return table;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace mneme::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
MNEME_EXPORT(const NearestKernels&, nearest_kernels, kernels)
#endif
