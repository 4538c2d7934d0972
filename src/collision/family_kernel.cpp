// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Compiled once per instruction set. A vector holds one box of time and parameters per lane.
//
// The middle of a box is checked as a single state, with each body inflated by what it may move
// within the box. To first order that is the sum of its speeds along time and along each parameter,
// times the box's half widths. The rest is bounded: for joint values that differ by at most D from
// those of the middle, and by at most `rest` from their linear part, a point at distance rho from
// the axes of the joints beyond it moves by at most
//   sum_g rho_g (rest_g + D_g (D_g / 2 + sum of D_f over turning joints f before g))
// farther. That is Taylor's formula; the second derivative by joints f and g, f nearer to the root,
// is z_f x (z_g x r_g). SweptMargins follow the same idea for one motion.
//
// Of motion along an obstacle only the part towards it counts: a body that stays on its side of the
// plane through the obstacle's nearest point stays free of it. Two links stay apart if both stay on
// their sides of a plane between them.
#include "collision/family_kernel.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "collision/family_kernel.cpp"  // NOLINT
#include "hwy/foreach_target.h"

#include "collision/state_checker-inl.h"
#include "simd/dispatch.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mneme::internal {
namespace HWY_NAMESPACE {
namespace {

constexpr int kMostDirections = 1 + kMostParameters;

/// The state in the middle of each box, and how joints change within it.
struct FamilyStates {
  int directions = 0;
  V half[kMostDirections];               // of time and parameters
  V middle[kMaxFrames];                  // joint values
  V rates[kMostDirections][kMaxFrames];  // by direction
  V rest[kMaxFrames];                    // bound on the change that is not linear
};

HWY_INLINE V load_lanes(std::span<const FamilyBox> boxes, const float FamilyBox::*member) {
  HWY_ALIGN float lanes[kLanes];
  for (int lane = 0; lane < kLanes; ++lane) {
    lanes[lane] = boxes[std::min(static_cast<size_t>(lane), boxes.size() - 1)].*member;
  }
  return hn::Load(Tag(), lanes);
}

HWY_INLINE V load_lanes(std::span<const FamilyBox> boxes,
                        const std::array<float, kMostParameters> FamilyBox::*member, int k) {
  HWY_ALIGN float lanes[kLanes];
  for (int lane = 0; lane < kLanes; ++lane) {
    const auto& row = boxes[std::min(static_cast<size_t>(lane), boxes.size() - 1)].*member;
    lanes[lane] = row[static_cast<size_t>(k)];
  }
  return hn::Load(Tag(), lanes);
}

/// Evaluates a family in the middle of each box. Lanes beyond the last box repeat it.
class FamilyStateMaker {
 public:
  HWY_INLINE FamilyStateMaker(const FamilyMotion& motion, std::span<const FamilyBox> boxes)
      : motion_(motion),
        parameters_(motion.shift->parameters),
        joints_(static_cast<int>(motion.from.size())),
        time_(load_lanes(boxes, &FamilyBox::time)),
        share_(hn::MulAdd(time_, splat(motion.last_share - motion.first_share),
                          splat(motion.first_share))) {
    states_.directions = 1 + parameters_;
    states_.half[0] = load_lanes(boxes, &FamilyBox::half_time);
    for (int k = 0; k < parameters_; ++k) {
      at_[k] = load_lanes(boxes, &FamilyBox::at, k);
      states_.half[1 + k] = load_lanes(boxes, &FamilyBox::half, k);
    }
  }

  HWY_INLINE const FamilyStates& make() {
    for (int j = 0; j < joints_; ++j) make_joint(j);
    return states_;
  }

 private:
  HWY_INLINE void make_joint(int j) {
    const GoalShift& shift = *motion_.shift;
    const V zero = hn::Zero(Tag());
    V value = splat(shift.constant[j]), linear = zero, curved = zero;
    for (int k = 0; k < parameters_; ++k) {
      V bend = zero;  // row k of the curvatures, times u
      for (int l = 0; l < parameters_; ++l) {
        const float entry = shift.curvatures[(k * parameters_ + l) * joints_ + j];
        bend = hn::MulAdd(splat(entry), at_[l], bend);
        curved = hn::MulAdd(splat(0.5f * std::abs(entry)),
                            hn::Mul(states_.half[1 + k], states_.half[1 + l]), curved);
      }
      const V slope = splat(shift.slopes[k * joints_ + j]);
      value = hn::MulAdd(hn::MulAdd(splat(0.5f), bend, slope), at_[k], value);
      const V rate = hn::Add(slope, bend);
      linear = hn::MulAdd(hn::Abs(rate), states_.half[1 + k], linear);
      states_.rates[1 + k][j] = hn::Mul(share_, rate);
    }
    const float growth = motion_.last_share - motion_.first_share;
    const float along = motion_.to[j] - motion_.from[j];
    states_.rates[0][j] = hn::MulAdd(splat(growth), value, splat(along));
    states_.middle[j] =
        hn::MulAdd(share_, value, hn::MulAdd(time_, splat(along), splat(motion_.from[j])));
    const V off = hn::Add(curved, splat(shift.rest[j]));
    const V mixed =
        hn::Mul(hn::Mul(states_.half[0], splat(std::abs(growth))), hn::Add(linear, off));
    states_.rest[j] = hn::MulAdd(share_, off, mixed);
  }

  const FamilyMotion& motion_;
  int parameters_, joints_;
  V time_, share_;
  V at_[kMostParameters];
  FamilyStates states_;
};

/// A length that is not less than that of `a`, and hardly more. Faster than a root.
HWY_INLINE V length_bound(const V3& a) {
  // After a step of Newton's method the coarsest instruction set is off by less than 5e-6.
  constexpr float kMore = 1.00001f, kLeast = 1e-20f;
  const V norm2 = hn::Max(squared_norm(a), splat(kLeast));
  const V rough = hn::ApproximateReciprocalSqrt(norm2);
  const V excess = hn::Mul(hn::Mul(norm2, rough), rough);
  const V inverse = hn::Mul(rough, hn::NegMulAdd(splat(0.5f), excess, splat(1.5f)));
  return hn::Mul(hn::Mul(splat(kMore), norm2), inverse);
}

/// A displacement bound by cause, metres.
struct Displacement {
  V along[kMostDirections];  // to first order, by direction
  V bent;                    // the rest
};

/// Margins that contain what bodies sweep within the boxes. Notes which body or pair was under
/// check when a lane was hit.
class BoxMargins {
 public:
  HWY_INLINE BoxMargins(const RobotTables& robot, const FamilyStates& states,
                        const FamilyMargins& margins, const Verdict<false>& verdict)
      : robot_(robot),
        states_(states),
        margins_(margins),
        verdict_(verdict),
        directed_(no_hit()),
        touching_(no_hit()) {
    for (V& towards : towards_) towards = hn::Zero(Tag());
  }

  static constexpr bool kIsDirected = true, kAreLinksDirected = true;

  [[nodiscard]] HWY_INLINE bool moves_body(int) const { return true; }
  [[nodiscard]] HWY_INLINE bool moves_pair(int) const { return margins_.has_links; }

  HWY_INLINE void follow(const Pose* poses) const {
    poses_ = poses;
    const V zero = hn::Zero(Tag());
    turned_[0] = zero;
    for (int k = 0; k < states_.directions; ++k)
      twists_[k][0] = {{zero, zero, zero}, {zero, zero, zero}};
    for (size_t i = 0; i < robot_.frames.size(); ++i) follow(robot_.frames[i], i + 1);
    for (int i = 0; i < robot_.moving_count; ++i) {
      const V3 center = center_of(i);
      const Displacement found = displacement(i, 0, center);
      bent_[i] = found.bent;
      body_margins_[i] = hn::Add(sum_of(found), splat(margins_.obstacles));
      widest_[i] = hn::GetLane(hn::MaxOfLanes(Tag(), body_margins_[i]));
    }
  }

  [[nodiscard]] HWY_INLINE V of_body(int i, const V3&) const {
    turn_to(i);
    return body_margins_[i];
  }
  [[nodiscard]] HWY_INLINE float widest_of_body(int i) const { return widest_[i]; }
  [[nodiscard]] HWY_INLINE V of_pair(int i, const V3*) const {
    turn_to(robot_.moving_count + i);
    const Displacement found = displacement_of_pair(i);
    pair_bent_ = found.bent;
    return hn::Add(sum_of(found), splat(margins_.links));
  }
  /// Returns those of the `asked` lanes in which the part of body `i` around `point` may move by
  /// `gap` against the unit vector `normal`.
  HWY_INLINE M find_reached(int i, const V3& point, const V3& normal, V gap, M asked) const {
    const V kept = splat(margins_.obstacles + kNormalRounding);
    Displacement found;
    found.bent = bent_[i];
    for (int k = 0; k < states_.directions; ++k)
      found.along[k] = hn::Mul(states_.half[k], speed_towards(i, 0, point, normal, k));
    return note_reached(found, kept, gap, hn::Lt(gap, kept), asked);
  }
  /// The same for the last pair of of_pair(): the plane between them is fixed to their ancestor.
  HWY_INLINE M find_reached(const BodyPairRow& pair, const PairAxes& axes, M asked) const {
    const V kept = splat(margins_.links + kNormalRounding);
    Displacement found;
    found.bent = pair_bent_;
    for (int k = 0; k < states_.directions; ++k) {
      const auto fastest = [&](int body, const V3* ends) {
        return hn::Max(speed_towards(body, pair.ancestor, ends[0], axes.normal, k),
                       speed_towards(body, pair.ancestor, ends[1], axes.normal, k));
      };
      const V speed = hn::Add(fastest(pair.first, axes.first), fastest(pair.second, axes.second));
      found.along[k] = hn::Mul(states_.half[k], speed);
    }
    const auto place = [&](const V3& end) { return dot(axes.normal, end); };
    const V lowest = hn::Min(place(axes.first[0]), place(axes.first[1]));
    const V highest = hn::Max(place(axes.second[0]), place(axes.second[1]));
    const V gap = hn::Sub(hn::Sub(lowest, highest), splat(axes.radii));
    const M touching = hn::Lt(hn::Sub(axes.apart, splat(axes.radii)), kept);
    return note_reached(found, kept, gap, touching, asked);
  }
  /// No value: tables decide vectors, and the verdict of a box must not depend on its neighbours.
  [[nodiscard]] HWY_INLINE V needed_rings(const SeparationTable&) const {
    return splat(SeparationTable::kMostRings + 1);
  }
  /// With a simple bound on the pair's approach.
  [[nodiscard]] HWY_INLINE V reach2(const BodyPairRow& pair, int) const {
    const float radii =
        robot_.bodies[pair.first].ball.radius + robot_.bodies[pair.second].ball.radius;
    const V approach =
        hn::Add(arc_of(pair.first, pair.ancestor), arc_of(pair.second, pair.ancestor));
    return squared(hn::Add(approach, splat(radii + margins_.links)));
  }

  /// Writes the verdicts of `count` lanes after a check. Lanes whose bodies move too far count as
  /// hit.
  HWY_INLINE void write(int count, FamilyVerdict* verdicts) const {
    turn_to(current_);
    unsigned open = bits_of(verdict_.hit);
    for (int lane = 0; lane < count; ++lane) {
      if (((open >> lane) & 1u) == 0) culprits_[lane] = find_wide(lane);
      verdicts[lane] = {};
      verdicts[lane].is_free = culprits_[lane] < 0;
      if (culprits_[lane] >= 0) open |= 1u << lane;
    }
    for (open &= (1u << count) - 1; open != 0;)
      open &= ~explain(culprits_[__builtin_ctz(open)], count, verdicts);
    explain_directed(count, verdicts);
  }

 private:
  struct Twist {
    V3 turn, speed;  // speed: of the point at the frame's origin
  };

  /// Speed of a point of a body along a direction, seen from the observer, by direction `k`.
  HWY_INLINE V speed_towards(int body, int observer, const V3& point, const V3& normal,
                             int k) const {
    const auto speed_of = [&](int frame) {
      const Twist& twist = twists_[k][frame];
      const V3 lever = cross(point - poses_[frame].origin, normal);
      return hn::Add(dot(twist.speed, normal), dot(twist.turn, lever));
    };
    return hn::Abs(hn::Sub(speed_of(robot_.bodies[body].frame), speed_of(observer)));
  }

  /// Returns and notes those of the `asked` lanes in which the displacement exceeds the gap.
  HWY_INLINE M note_reached(const Displacement& found, V kept, V gap, M touching, M asked) const {
    const M reached = hn::And(asked, hn::Lt(gap, hn::Add(sum_of(found), kept)));
    const M fresh = hn::AndNot(verdict_.hit, reached);
    directed_ = hn::Or(directed_, fresh);
    touching_ = hn::Or(touching_, hn::And(fresh, touching));
    for (int k = 0; k < states_.directions; ++k)
      towards_[k] = hn::IfThenElse(fresh, found.along[k], towards_[k]);
    return reached;
  }

  HWY_INLINE void follow(const FrameRow& frame, size_t index) const {
    const V3 arm = poses_[index].origin - poses_[frame.parent].origin;
    arms_[index] = length_bound(arm);
    const V scale = splat(frame.multiplier);
    V moved = hn::Mul(hn::Abs(scale), states_.rest[frame.joint]);
    rest_[index] = moved;
    for (int k = 0; k < states_.directions; ++k) {
      const Twist& parent = twists_[k][frame.parent];
      Twist twist{parent.turn, parent.speed + cross(parent.turn, arm)};
      const V rate = hn::Mul(scale, states_.rates[k][frame.joint]);
      V3& changed = frame.is_prismatic ? twist.speed : twist.turn;
      changed = mul_add(rate, poses_[index].axes[2], changed);
      twists_[k][index] = twist;
      moved = hn::MulAdd(hn::Abs(rate), states_.half[k], moved);
    }
    moved_[index] = moved;
    if (frame.is_prismatic) arms_[index] = hn::Add(arms_[index], moved);
    turned_[index] =
        frame.is_prismatic ? turned_[frame.parent] : hn::Add(turned_[frame.parent], moved);
  }

  [[nodiscard]] HWY_INLINE V3 center_of(int i) const {
    const BodyRow& body = robot_.bodies[i];
    return transform_point(poses_[body.frame], body.ball.center);
  }

  /// Calls `visit(index, frame, lever)` for the frames that carry a body and not the observer, from
  /// the body on. No point of the body is farther than `lever` from the frame's axis in the box.
  template <class Visit>
  HWY_INLINE void visit_frames(int i, int observer, const Visit& visit) const {
    const BodyRow& body = robot_.bodies[i];
    const float* c = body.ball.center;
    V lever = splat(std::sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]) + body.ball.radius);
    for (int index = body.frame; index > observer;) {
      const FrameRow& frame = robot_.frames[index - 1];
      visit(index, frame, lever);
      lever = hn::Add(lever, arms_[index]);
      index = frame.parent;
    }
  }

  /// Bound on the arc of a body's points, seen from the observer.
  [[nodiscard]] HWY_INLINE V arc_of(int i, int observer) const {
    V arc = hn::Zero(Tag());
    visit_frames(i, observer, [&](int index, const FrameRow& frame, V lever) {
      arc =
          frame.is_prismatic ? hn::Add(arc, moved_[index]) : hn::MulAdd(moved_[index], lever, arc);
    });
    return arc;
  }

  [[nodiscard]] HWY_INLINE Displacement displacement(int i, int observer, const V3& center) const {
    const BodyRow& body = robot_.bodies[i];
    const V radius = splat(body.ball.radius);
    Displacement result;
    if (body.frame == observer) {
      for (V& along : result.along) along = hn::Zero(Tag());
      result.bent = hn::Zero(Tag());
      return result;
    }
    for (int k = 0; k < states_.directions; ++k) {
      const Twist &own = twists_[k][body.frame], &other = twists_[k][observer];
      const V3 speed = own.speed + cross(own.turn, center - poses_[body.frame].origin) -
                       other.speed - cross(other.turn, center - poses_[observer].origin);
      const V turn = length_bound(own.turn - other.turn);
      result.along[k] = hn::Mul(states_.half[k], hn::MulAdd(turn, radius, length_bound(speed)));
    }
    V bent = hn::Zero(Tag()), beyond = bent;  // `beyond`: arcs by joints beyond the frame
    visit_frames(i, observer, [&](int index, const FrameRow& frame, V lever) {
      const V moved = moved_[index];
      const V before = hn::Sub(turned_[frame.parent], turned_[observer]);
      if (frame.is_prismatic) {
        bent = hn::Add(bent, hn::MulAdd(moved, before, rest_[index]));
        beyond = hn::Add(beyond, moved);
        return;
      }
      const V3 arm = cross(poses_[index].axes[2], center - poses_[index].origin);
      const V rho = hn::Add(length_bound(arm), hn::Add(radius, beyond));
      const V off = hn::MulAdd(moved, hn::MulAdd(splat(0.5f), moved, before), rest_[index]);
      bent = hn::MulAdd(off, rho, bent);
      beyond = hn::MulAdd(moved, lever, beyond);
    });
    result.bent = bent;
    return result;
  }

  [[nodiscard]] HWY_INLINE Displacement displacement_of_pair(int i) const {
    const BodyPairRow& pair = robot_.body_pairs[i];
    Displacement sum = displacement(pair.first, pair.ancestor, center_of(pair.first));
    const Displacement other = displacement(pair.second, pair.ancestor, center_of(pair.second));
    for (int k = 0; k < states_.directions; ++k)
      sum.along[k] = hn::Add(sum.along[k], other.along[k]);
    sum.bent = hn::Add(sum.bent, other.bent);
    return sum;
  }

  [[nodiscard]] HWY_INLINE V sum_of(const Displacement& displacement) const {
    V sum = displacement.bent;
    for (int k = 0; k < states_.directions; ++k) sum = hn::Add(sum, displacement.along[k]);
    return sum;
  }

  /// Assigns lanes that were hit since the last call to the body or pair that was under check.
  HWY_INLINE void turn_to(int next) const {
    const unsigned hits = bits_of(verdict_.hit);
    for (unsigned fresh = hits & ~known_; fresh != 0; fresh &= fresh - 1) {
      culprits_[__builtin_ctz(fresh)] = current_;
    }
    known_ = hits;
    current_ = next;
  }

  /// A body that may move too far in a lane, or -1.
  [[nodiscard]] HWY_INLINE int find_wide(int lane) const {
    for (int i = 0; i < robot_.moving_count; ++i) {
      if (!(widest_[i] > margins_.most_displacement)) continue;
      HWY_ALIGN float lanes[kLanes];
      hn::Store(body_margins_[i], Tag(), lanes);
      if (lanes[lane] > margins_.most_displacement) return i;
    }
    return -1;
  }

  /// Writes the displacements of the lanes with this culprit. Returns a bit for each.
  HWY_INLINE unsigned explain(int culprit, int count, FamilyVerdict* verdicts) const {
    const Displacement found = culprit < robot_.moving_count
                                   ? displacement(culprit, 0, center_of(culprit))
                                   : displacement_of_pair(culprit - robot_.moving_count);
    HWY_ALIGN float lanes[kLanes];
    unsigned explained = 0;
    const auto write = [&](V values, auto&& place) {
      hn::Store(values, Tag(), lanes);
      for (int lane = 0; lane < count; ++lane) {
        if (culprits_[lane] != culprit) continue;
        place(verdicts[lane]) = lanes[lane];
        explained |= 1u << lane;
      }
    };
    for (int k = 0; k < states_.directions; ++k) {
      write(found.along[k],
            [k](FamilyVerdict& v) -> float& { return v.displacements[static_cast<size_t>(k)]; });
    }
    write(found.bent, [](FamilyVerdict& v) -> float& { return v.bent; });
    return explained;
  }

  /// Writes the displacements of lanes that may move up to an obstacle or another link.
  HWY_INLINE void explain_directed(int count, FamilyVerdict* verdicts) const {
    for (int lane = 0; lane < count; ++lane) verdicts[lane].towards = verdicts[lane].displacements;
    const unsigned directed = bits_of(directed_), touching = bits_of(touching_);
    HWY_ALIGN float lanes[kLanes];
    for (int k = 0; k < states_.directions && directed != 0; ++k) {
      hn::Store(towards_[k], Tag(), lanes);
      for (int lane = 0; lane < count; ++lane) {
        if (((directed >> lane) & 1u) == 0) continue;
        verdicts[lane].towards[static_cast<size_t>(k)] = lanes[lane];
        verdicts[lane].is_in_contact = ((touching >> lane) & 1u) != 0;
      }
    }
  }

  const RobotTables& robot_;
  const FamilyStates& states_;
  const FamilyMargins& margins_;
  const Verdict<false>& verdict_;
  mutable const Pose* poses_ = nullptr;
  mutable Twist twists_[kMostDirections][kMaxFrames + 1];
  mutable V rest_[kMaxFrames + 1], moved_[kMaxFrames + 1], turned_[kMaxFrames + 1];
  mutable V arms_[kMaxFrames + 1];  // bounds on the distance from the parent's origin in the box
  mutable V body_margins_[kMaxBodies];
  mutable V bent_[kMaxBodies];
  mutable V pair_bent_;  // of the last pair
  // Of lanes that may move up to an obstacle or another link:
  mutable M directed_, touching_;
  mutable V towards_[kMostDirections];
  mutable float widest_[kMaxBodies];
  mutable int current_ = 0;
  mutable unsigned known_ = 0;
  mutable int culprits_[kLanes];
};

void check_family(const RobotTables& robot, const SceneTables& scene, const FamilyMotion& motion,
                  std::span<const FamilyBox> boxes, const FamilyMargins& margins,
                  std::span<FamilyVerdict> verdicts) {
  assert(robot.frames.size() <= kMaxFrames && motion.shift->parameters <= kMostParameters);
  for (size_t begin = 0; begin < boxes.size(); begin += kLanes) {
    const size_t count = std::min<size_t>(kLanes, boxes.size() - begin);
    FamilyStateMaker maker(motion, boxes.subspan(begin, count));
    const FamilyStates& states = maker.make();
    Verdict<false> verdict;
    const BoxMargins box_margins(robot, states, margins, verdict);
    CheckCounters ignored;
    StateChecker<false, BoxMargins> checker(robot, scene, box_margins, ignored);
    checker.check(states.middle, verdict);
    box_margins.write(static_cast<int>(count), verdicts.data() + begin);
  }
}

FamilyKernel kernel() { return &check_family; }

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace mneme::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
MNEME_EXPORT(FamilyKernel, family_kernel, kernel)
#endif
