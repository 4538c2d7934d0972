// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Margins of bodies. For single states all bodies have one margin. For a sweep, each body's margin
// is its displacement around the state. A margin is one float for all lanes, or one per lane.
#if defined(MNEME_COLLISION_MARGINS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MNEME_COLLISION_MARGINS_INL_H_
#undef MNEME_COLLISION_MARGINS_INL_H_
#else
#define MNEME_COLLISION_MARGINS_INL_H_
#endif

#include <cassert>
#include <cmath>

#include "collision/collision_kernels.h"
#include "collision/kinematics-inl.h"
#include "tables/separation_table-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mneme::internal {
namespace HWY_NAMESPACE {

HWY_INLINE float sum(float a, float b) { return a + b; }
HWY_INLINE V sum(float a, V b) { return hn::Add(splat(a), b); }
HWY_INLINE float squared(float x) { return x * x; }
HWY_INLINE V squared(V x) { return hn::Mul(x, x); }
HWY_INLINE V lanes_of(float x) { return splat(x); }
HWY_INLINE V lanes_of(V x) { return x; }

/// One margin for all bodies; negative, it deflates them.
class EvenMargins {
 public:
  /// True if margins depend on the direction of contact: find_reached() decides then.
  static constexpr bool kIsDirected = false, kAreLinksDirected = false;

  HWY_INLINE explicit EvenMargins(float margin) : margin_(margin) { assert(std::isfinite(margin)); }

  HWY_INLINE void follow(const Pose*) const {}

  [[nodiscard]] HWY_INLINE bool moves_body(int) const { return true; }
  [[nodiscard]] HWY_INLINE bool moves_pair(int) const { return true; }
  [[nodiscard]] HWY_INLINE float of_body(int, const V3&) const { return margin_; }
  [[nodiscard]] HWY_INLINE float widest_of_body(int) const { return margin_; }
  [[nodiscard]] HWY_INLINE float of_pair(int, const V3*) const { return 0; }
  /// Least value in a separation table that proves a pair apart.
  [[nodiscard]] HWY_INLINE V needed_rings(const SeparationTable&) const { return splat(1); }
  /// Squared distance of a pair's centres below which its balls touch.
  [[nodiscard]] HWY_INLINE float reach2(const BodyPairRow& pair, int) const { return pair.reach2; }

 private:
  float margin_;
};

/// The axes of a part of each body of a pair, in the root's frame.
struct PairAxes {
  V3 first[2], second[2];  ///< ends
  V3 normal;               ///< unit vector from the second to the first where they are nearest
  V apart;                 ///< distance of the axes there
  float radii = 0;         ///< sum
};

/// Larger than what rounding of the normal to an obstacle costs, metres.
constexpr float kNormalRounding = 2e-5f;

/// The motions of a vector's lanes: per joint, where each begins and its displacement.
struct LaneMotions {
  V number;  ///< of the motion in its chain
  V from[kMaxFrames], delta[kMaxFrames];
};

/// Margins that contain the sweep of motions of constant joint speeds around their states. Within
/// half an interval h, a point moves at most h times the body's displacement bound. It also moves
/// at most h v + h^2 a/2, with its speed v at the state and its acceleration a. The acceleration is
/// the sum of |q_i' q_j'| |z_i x (z_j x r_j)| over pairs of joints, i nearer to the root. It is at
/// most 2 * bound * (sum of all turns).
class SweptMargins {
 public:
  static constexpr bool kIsDirected = true, kAreLinksDirected = false;

  HWY_INLINE SweptMargins(const RobotTables& robot, const SweptChain& chain)
      : robot_(robot),
        chain_(chain),
        half_(hn::Zero(Tag())),
        since_end_(hn::Zero(Tag())),
        turns_(hn::Zero(Tag())) {
    const V zero = hn::Zero(Tag());
    twists_[0] = {{zero, zero, zero}, {zero, zero, zero}};
  }

  /// The motions of the next intervals. Refers to them.
  HWY_INLINE void set_motions(const LaneMotions& motions) {
    motions_ = &motions;
    turns_ = hn::Zero(Tag());
    for (const FrameRow& frame : robot_.frames) {
      if (frame.is_prismatic) continue;
      const V turn = hn::Mul(splat(frame.multiplier), motions.delta[frame.joint]);
      turns_ = hn::Add(turns_, hn::Abs(turn));
    }
  }
  /// Intervals from `middle` - `half` to `middle` + `half`, of at most `widest` on either side.
  HWY_INLINE void set_intervals(V middle, V half, float widest) {
    half_ = half;
    widest_ = widest;
    since_end_ = splat(1e30f);
    const auto add_end = [&](bool is_end, float number, V share) {
      const M is_here = hn::Eq(motions_->number, splat(number));
      if (is_end) since_end_ = hn::Min(since_end_, hn::IfThenElse(is_here, share, since_end_));
    };
    add_end(chain_.is_from_start, 0, middle);
    add_end(chain_.is_to_goal, static_cast<float>(chain_.count - 1), hn::Sub(splat(1.0f), middle));
  }

  [[nodiscard]] HWY_INLINE bool moves_body(int i) const { return chain_.body_displacements[i] > 0; }
  [[nodiscard]] HWY_INLINE bool moves_pair(int i) const { return chain_.pair_displacements[i] > 0; }
  /// Computes the frames' speeds at the poses of a state. Call before the margins below.
  HWY_INLINE void follow(const Pose* poses) const {
    poses_ = poses;
    for (size_t i = 0; i < robot_.frames.size(); ++i) {
      const FrameRow& frame = robot_.frames[i];
      const Twist& parent = twists_[frame.parent];
      const V3 arm = poses[i + 1].origin - poses[frame.parent].origin;
      Twist twist{parent.turn, parent.speed + cross(parent.turn, arm)};
      V3& moved = frame.is_prismatic ? twist.speed : twist.turn;
      const V rate = hn::Mul(splat(frame.multiplier), motions_->delta[frame.joint]);
      moved = mul_add(rate, poses[i + 1].axes[2], moved);
      twists_[i + 1] = twist;
    }
  }

  [[nodiscard]] HWY_INLINE V of_body(int i, const V3& center) const {
    return sum(chain_.obstacle_margin,
               inflation(chain_.body_displacements[i], speed_of(i, 0, center)));
  }
  /// Returns those of the `asked` lanes in which the part of body `i` around `point` may move by
  /// `gap` against the unit vector `normal`.
  [[nodiscard]] HWY_INLINE M find_reached(int i, const V3& point, const V3& normal, V gap,
                                          M asked) const {
    const int frame = robot_.bodies[i].frame;
    const Twist& twist = twists_[frame];
    const V3 lever = cross(point - poses_[frame].origin, normal);
    const V speed = hn::Abs(hn::Add(dot(twist.speed, normal), dot(twist.turn, lever)));
    const V inflated = inflation(chain_.body_displacements[i], speed);
    const V reach = hn::Add(inflated, splat(chain_.obstacle_margin + kNormalRounding));
    return hn::And(asked, hn::Lt(gap, reach));
  }
  [[nodiscard]] HWY_INLINE float widest_of_body(int i) const {
    return chain_.obstacle_margin + chain_.margin + widest_ * chain_.body_displacements[i];
  }
  [[nodiscard]] HWY_INLINE V of_pair(int i, const V3* centers) const {
    const BodyPairRow& pair = robot_.body_pairs[i];
    const V first = speed_of(pair.first, pair.ancestor, centers[pair.first]);
    const V second = speed_of(pair.second, pair.ancestor, centers[pair.second]);
    return inflation(chain_.pair_displacements[i], hn::Add(first, second));
  }
  /// The intervals reach this number of cells to either side, and the state's own cell.
  [[nodiscard]] HWY_INLINE V needed_rings(const SeparationTable& table) const {
    if (chain_.margin > SeparationTable::kApart) return splat(SeparationTable::kMostRings + 1);
    V cells = hn::Zero(Tag());
    for (const SeparationTable::Axis& axis : table.axes) {
      const V moved = hn::Abs(motions_->delta[axis.joint]);
      cells = hn::Max(cells, hn::Mul(moved, splat(axis.scale)));
    }
    return rings_around(hn::Mul(half_, cells));
  }
  [[nodiscard]] HWY_INLINE V reach2(const BodyPairRow& pair, int i) const {
    const float radii =
        robot_.bodies[pair.first].ball.radius + robot_.bodies[pair.second].ball.radius;
    const float bound = chain_.pair_displacements[i];
    return squared(sum(radii, inflation(bound, splat(bound))));
  }

 private:
  /// Speeds at the state, radians and metres per motion.
  struct Twist {
    V3 turn, speed;
  };

  /// Bound on the speed of a body's points, seen from a frame.
  [[nodiscard]] HWY_INLINE V speed_of(int i, int observer, const V3& center) const {
    const BodyRow& body = robot_.bodies[i];
    const Twist &own = twists_[body.frame], &other = twists_[observer];
    const V3 speed = own.speed + cross(own.turn, center - poses_[body.frame].origin) - other.speed -
                     cross(other.turn, center - poses_[observer].origin);
    const V turn = hn::Sqrt(squared_norm(own.turn - other.turn));
    return hn::MulAdd(turn, splat(body.ball.radius), hn::Sqrt(squared_norm(speed)));
  }

  /// The margin of a body with this displacement bound and this speed at the state.
  [[nodiscard]] HWY_INLINE V inflation(float bound, V speed) const {
    const V grown = hn::Mul(splat(SweptChain::kMarginGrowth * bound), since_end_);
    const V bent = hn::MulAdd(half_, hn::Mul(turns_, splat(bound)), splat(kRounding * bound));
    const V rate = hn::Min(hn::Add(speed, bent), splat(bound));
    return hn::MulAdd(half_, rate, hn::Min(splat(chain_.margin), grown));
  }

  /// Relative to the bound; larger than the rounding errors of single precision.
  static constexpr float kRounding = 1e-5f;

  const RobotTables& robot_;
  const SweptChain& chain_;
  const LaneMotions* motions_ = nullptr;
  V half_, since_end_;
  V turns_;  // sum over all joints, radians
  float widest_ = 0;
  mutable const Pose* poses_ = nullptr;
  mutable Twist twists_[kMaxFrames + 1];
};

}  // namespace HWY_NAMESPACE
}  // namespace mneme::internal
HWY_AFTER_NAMESPACE();

#endif  // MNEME_COLLISION_MARGINS_INL_H_
