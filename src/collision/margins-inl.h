// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// By how much bodies are inflated: all alike at a state, or by how far each may move around it.
#if defined(MNEME_COLLISION_MARGINS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MNEME_COLLISION_MARGINS_INL_H_
#undef MNEME_COLLISION_MARGINS_INL_H_
#else
#define MNEME_COLLISION_MARGINS_INL_H_
#endif

#include "collision/collision_kernels.h"
#include "collision/tables.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mneme::internal {
namespace HWY_NAMESPACE {

// A margin is one float for all lanes, or one per lane.
HWY_INLINE float sum(float a, float b) { return a + b; }
HWY_INLINE V sum(float a, V b) { return hn::Add(splat(a), b); }
HWY_INLINE float squared(float x) { return x * x; }
HWY_INLINE V squared(V x) { return hn::Mul(x, x); }
HWY_INLINE V lanes_of(float x) { return splat(x); }
HWY_INLINE V lanes_of(V x) { return x; }

/// The same for all bodies.
class EvenMargins {
 public:
  HWY_INLINE explicit EvenMargins(float margin) : margin_(margin) {}

  [[nodiscard]] HWY_INLINE bool moves_body(int) const { return true; }
  [[nodiscard]] HWY_INLINE bool moves_pair(int) const { return true; }
  [[nodiscard]] HWY_INLINE float of_body(int) const { return margin_; }
  [[nodiscard]] HWY_INLINE float widest_of_body(int) const { return margin_; }
  [[nodiscard]] HWY_INLINE float of_pair(int) const { return 0; }
  /// Squared, between the centres of a pair's balls.
  [[nodiscard]] HWY_INLINE float reach2(const BodyPairRow& pair, int) const { return pair.reach2; }

 private:
  float margin_;
};

/// What a motion of constant joint speeds sweeps in the intervals around its states: no point of a
/// body moves farther than half the interval's share of the body's way.
class SweptMargins {
 public:
  HWY_INLINE SweptMargins(const RobotTables& robot, const SweptMotion& motion)
      : robot_(robot), motion_(motion), half_(hn::Zero(Tag())), since_end_(hn::Zero(Tag())) {}

  /// Intervals from `middle` - `half` to `middle` + `half`, of at most `widest` on either side.
  HWY_INLINE void set(V middle, V half, float widest) {
    half_ = half;
    widest_ = widest;
    const V never = splat(1e30f);
    since_end_ = hn::Min(motion_.is_from_start ? middle : never,
                         motion_.is_to_goal ? hn::Sub(splat(1.0f), middle) : never);
  }

  [[nodiscard]] HWY_INLINE bool moves_body(int i) const { return motion_.body_ways[i] > 0; }
  [[nodiscard]] HWY_INLINE bool moves_pair(int i) const { return motion_.pair_ways[i] > 0; }
  [[nodiscard]] HWY_INLINE V of_body(int i) const {
    return sum(motion_.obstacle_margin, inflation(motion_.body_ways[i]));
  }
  [[nodiscard]] HWY_INLINE float widest_of_body(int i) const {
    return motion_.obstacle_margin + motion_.margin + widest_ * motion_.body_ways[i];
  }
  [[nodiscard]] HWY_INLINE V of_pair(int i) const { return inflation(motion_.pair_ways[i]); }
  [[nodiscard]] HWY_INLINE V reach2(const BodyPairRow& pair, int i) const {
    const float radii =
        robot_.bodies[pair.first].ball.radius + robot_.bodies[pair.second].ball.radius;
    return squared(sum(radii, of_pair(i)));
  }

 private:
  [[nodiscard]] HWY_INLINE V inflation(float way) const {
    const V grown = hn::Mul(splat(SweptMotion::kMarginGrowth * way), since_end_);
    return hn::MulAdd(half_, splat(way), hn::Min(splat(motion_.margin), grown));
  }

  const RobotTables& robot_;
  const SweptMotion& motion_;
  V half_, since_end_;
  float widest_ = 0;
};

}  // namespace HWY_NAMESPACE
}  // namespace mneme::internal
HWY_AFTER_NAMESPACE();

#endif  // MNEME_COLLISION_MARGINS_INL_H_
