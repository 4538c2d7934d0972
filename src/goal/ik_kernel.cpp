// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Compiled once per instruction set. A vector holds one seed per lane.
//
// Levenberg and Marquardt's method with the damping of Sugihara (DOI 10.1109/TRO.2011.2148230): the
// square of the error itself. This damping makes steps short far from the target and near
// singularities, and convergence quadratic. All quantities are in the target's frame, so that
// tolerances are along axes.
#include "goal/ik_kernel.h"

#include <algorithm>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "goal/ik_kernel.cpp"  // NOLINT
#include "hwy/foreach_target.h"

#include "collision/kinematics-inl.h"
#include "simd/dispatch.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mneme::internal {
namespace HWY_NAMESPACE {
namespace {

inline constexpr int kSeedLanes = HWY_LANES(float);
/// Metres that weigh as much as a radian.
constexpr float kMetresPerRadian = 0.25f;
/// Added to the damping, so that systems can be solved at the target too: relative to the longest
/// lever of a joint, squared, where that is longer than a metre.
constexpr float kLeastDamping = 1e-6f;
/// Radians or metres that a joint moves in a step, at most.
constexpr float kLongestStep = 1.0f;

/// The motion that would bring the tip to the target.
struct TipError {
  V3 position;  ///< metres
  V3 rotation;  ///< axis times 2 sin(angle / 2); shorter near half a turn, where no axis is unique
  V rotation2;  ///< (2 sin(angle / 2))^2
  V3 axis;      ///< the tip's approach axis
  M leans, turns;  ///< lanes with an error of the lean, of the turn
};

class IkSolver {
 public:
  HWY_INLINE IkSolver(const RobotTables& chain, const IkTask& request)
      : chain_(chain), request_(request), target_(*request.target) {
    set_rotation(target_.rotation.data(), poses_[0]);
    poses_[0].origin = splat(target_.translation.data());
  }

  /// Replaces the seeds `q` by their results and writes the squared errors. Returns the number of
  /// lanes at the target; ends as soon as there are `enough`.
  HWY_INLINE int solve(int enough, V* q, V& position2, V& rotation2) {
    for (int round = 0;; ++round) {
      pose_frames(chain_, q, poses_);
      const TipError error = find_error();
      position2 = squared_norm(error.position);
      rotation2 = error.rotation2;
      const M is_done = hn::And(hn::Le(position2, splat(target_.near_m * target_.near_m)),
                                hn::Le(rotation2, splat(target_.near_chord * target_.near_chord)));
      const int done = static_cast<int>(hn::CountTrue(Tag(), is_done));
      if (round == request_.rounds || done >= std::min(enough, kSeedLanes)) return done;
      step(error, position2, rotation2, is_done, q);
    }
  }

 private:
  [[nodiscard]] HWY_INLINE V3 tip_axis(const Pose& pose, int column) const {
    const float* r = target_.tip_rotation.data() + column;
    return mul_add(splat(r[0]), pose.axes[0],
                   mul_add(splat(r[3]), pose.axes[1], splat(r[6]) * pose.axes[2]));
  }

  /// The part of x beyond +-`most`.
  static HWY_INLINE V beyond(V x, float most) {
    return hn::Sub(x, hn::Min(hn::Max(x, splat(-most)), splat(most)));
  }

  [[nodiscard]] HWY_INLINE TipError find_error() {
    const Pose& pose = poses_[target_.frame];
    tip_ = transform_point(pose, target_.tip_translation.data());
    TipError error;
    error.position = negated(V3{beyond(tip_.x, target_.box[0]), beyond(tip_.y, target_.box[1]),
                                beyond(tip_.z, target_.box[2])});
    const V3 x = tip_axis(pose, 0), y = tip_axis(pose, 1);
    error.axis = cross(x, y);
    if (target_.lean == 0 && target_.turn == 0) {
      find_turn_to_axes(x, y, error);
    } else {
      find_lean_and_turn(x, y, error);
    }
    return error;
  }

  /// `twice_square` is 2 cos^2(angle / 2). Below the limit the axis is lost in rounding.
  static HWY_INLINE M is_half_turn(V twice_square) { return hn::Lt(twice_square, splat(1e-6f)); }

  /// 1 / cos(angle / 2) from twice its cosine squared; finite at half a turn.
  static HWY_INLINE V inverse_half_cosine(V twice_square) {
    return hn::Sqrt(hn::Div(splat(2.0f), hn::Max(twice_square, splat(1e-6f))));
  }

  /// The shortest rotation from x, y, z to the axes of the target.
  static HWY_INLINE void find_turn_to_axes(const V3& x, const V3& y, TipError& error) {
    const V3& z = error.axis;
    const V half = splat(0.5f);
    const V3 sine = half * V3{hn::Sub(z.y, y.z), hn::Sub(x.z, z.x), hn::Sub(y.x, x.y)};
    const V trace = hn::Add(x.x, hn::Add(y.y, z.z));
    const V twice_square = hn::Mul(half, hn::Add(trace, splat(1.0f)));
    error.rotation = inverse_half_cosine(twice_square) * sine;
    error.rotation2 =
        hn::IfThenElse(is_half_turn(twice_square), splat(4.0f), squared_norm(error.rotation));
  }

  /// Splits the rotation into a lean of the tip's axis and a turn about it.
  HWY_INLINE void find_lean_and_turn(const V3& x, const V3& y, TipError& error) const {
    const V zero = hn::Zero(Tag()), one = splat(1.0f), two = splat(2.0f);
    const V3& z = error.axis;
    const V twice_square = hn::Add(one, z.z);
    const V3 leaning = inverse_half_cosine(twice_square) * V3{z.y, hn::Neg(z.x), zero};
    const M is_upside_down = is_half_turn(twice_square);
    // Each form is exact where the other one is lost in rounding.
    const V length =
        hn::IfThenElse(hn::Lt(z.z, zero), hn::Min(two, hn::Sqrt(hn::Mul(two, hn::Sub(one, z.z)))),
                       hn::Sqrt(squared_norm(leaning)));
    const V excess = hn::Max(zero, hn::Sub(length, splat(target_.lean)));
    error.leans = hn::Gt(excess, zero);
    const V3 lean =
        hn::IfThenElseZero(error.leans, hn::Div(excess, hn::Max(length, splat(1e-6f)))) * leaning;
    // The twist of the whole rotation's quaternion about the axis.
    const V w = hn::Add(one, hn::Add(x.x, hn::Add(y.y, z.z)));
    const V about = hn::Sub(y.x, x.y);
    const V norm = hn::Sqrt(hn::MulAdd(w, w, hn::Mul(about, about)));
    // At half a turn rounding decides the direction.
    const V turned = hn::IfThenElse(hn::Lt(norm, splat(1e-5f)), hn::CopySign(two, about),
                                    hn::Div(hn::Mul(two, about), norm));
    const V turn = beyond(turned, target_.turn);
    error.turns = hn::Ne(turn, zero);
    error.rotation = mul_add(turn, z, lean);
    error.rotation2 =
        hn::IfThenElse(is_upside_down, hn::MulAdd(excess, excess, hn::Mul(turn, turn)),
                       squared_norm(error.rotation));
  }

  HWY_INLINE void step(const TipError& error, V position2, V rotation2, M is_done, V* q) {
    const int joints = chain_.joint_count;
    int joint[kMaxFrames];
    V3 slopes[kMaxFrames], turns[kMaxFrames];
    const int count = find_slopes(chain_, poses_, target_.frame, tip_, joint, slopes, turns);
    const V weight = splat(kMetresPerRadian);
    for (int i = 0; i < count; ++i) turns[i] = weight * turns[i];
    const V3 rotation = weight * error.rotation;
    V lever2 = splat(1.0f);
    for (int i = 0; i < count; ++i) {
      lever2 = hn::Max(lever2, squared_norm(slopes[i]));
      const V pull = hn::Add(dot(slopes[i], error.position), dot(turns[i], rotation));
      const M stays = is_held(joint[i], pull, q);
      slopes[i] = unless(stays, slopes[i]);
      turns[i] = unless(stays, turns[i]);
    }
    V wish[kMostWalkingJoints], change[kMostWalkingJoints];
    for (int j = 0; j < joints; ++j) wish[j] = hn::Zero(Tag());
    const V square = hn::MulAdd(splat(kMetresPerRadian * kMetresPerRadian), rotation2, position2);
    const V least = hn::Mul(splat(kLeastDamping), lever2);
    equations_.reset(joints, hn::MulAdd(splat(0.05f), square, least), wish);
    add_rows(error, joint, slopes, turns, count, rotation);
    equations_.solve(change);
    V most = splat(kLongestStep);
    for (int j = 0; j < joints; ++j) most = hn::Max(most, hn::Abs(change[j]));
    const V scale = hn::IfThenZeroElse(is_done, hn::Div(splat(kLongestStep), most));
    for (int j = 0; j < joints; ++j) {
      const V moved = hn::MulAdd(scale, change[j], q[j]);
      q[j] = hn::Max(splat(request_.lower[j]), hn::Min(splat(request_.upper[j]), moved));
    }
  }

  /// Lanes in which a joint stands at a limit and would go beyond.
  [[nodiscard]] HWY_INLINE M is_held(int joint, V pull, const V* q) const {
    const V zero = hn::Zero(Tag());
    return hn::Or(hn::And(hn::Ge(q[joint], splat(request_.upper[joint])), hn::Gt(pull, zero)),
                  hn::And(hn::Le(q[joint], splat(request_.lower[joint])), hn::Lt(pull, zero)));
  }

  static HWY_INLINE V3 unless(M mask, const V3& a) {
    return {hn::IfThenZeroElse(mask, a.x), hn::IfThenZeroElse(mask, a.y),
            hn::IfThenZeroElse(mask, a.z)};
  }

  /// Adds equations only for directions in which the tip is outside its tolerance.
  HWY_INLINE void add_rows(const TipError& error, const int* joint, V3* slopes, V3* turns,
                           int count, const V3& rotation) {
    const V zero = hn::Zero(Tag());
    const auto free_axis = [&](float box, V e) {
      return box > 0 ? hn::Eq(e, zero) : hn::MaskFromVec(zero);
    };
    const M free[3] = {free_axis(target_.box[0], error.position.x),
                       free_axis(target_.box[1], error.position.y),
                       free_axis(target_.box[2], error.position.z)};
    for (int i = 0; i < count; ++i) {
      slopes[i] = {hn::IfThenZeroElse(free[0], slopes[i].x),
                   hn::IfThenZeroElse(free[1], slopes[i].y),
                   hn::IfThenZeroElse(free[2], slopes[i].z)};
    }
    equations_.add(joint, slopes, count, error.position);
    if (target_.lean != 0 || target_.turn != 0) {
      for (int i = 0; i < count; ++i) {
        const V about = dot(turns[i], error.axis);
        const V kept = hn::IfThenElseZero(error.turns, about);
        const V3 across = mul_add(hn::Neg(about), error.axis, turns[i]);
        turns[i] = mul_add(kept, error.axis, unless(hn::Not(error.leans), across));
      }
    }
    equations_.add(joint, turns, count, rotation);
  }

  const RobotTables& chain_;
  const IkTask& request_;
  const IkTarget& target_;
  Pose poses_[kMaxFrames + 1];
  V3 tip_;
  NormalEquations equations_;
};

void solve_ik(const RobotTables& chain, const IkTask& request, float* rows, IkError* errors) {
  const Tag d;
  const hn::RebindToSigned<Tag> di;
  IkSolver solver(chain, request);
  const int joints = chain.joint_count;
  V q[kMostWalkingJoints];
  HWY_ALIGN float column[kSeedLanes], errors2[2][kSeedLanes];
  int done = 0;
  for (int begin = 0; begin < request.count; begin += kSeedLanes) {
    const int lanes = std::min(kSeedLanes, request.count - begin);
    if (done >= request.enough) {
      constexpr float kUntried = std::numeric_limits<float>::infinity();
      std::fill_n(errors + begin, lanes, IkError{kUntried, kUntried});
      continue;
    }
    // Lanes beyond the last seed repeat it.
    const auto row = hn::Min(hn::Iota(di, begin), hn::Set(di, request.count - 1));
    const auto first = hn::Mul(row, hn::Set(di, joints));
    for (int j = 0; j < joints; ++j) q[j] = hn::GatherIndex(d, request.seeds + j, first);
    V position2, rotation2;
    done += solver.solve(request.enough - done, q, position2, rotation2);
    hn::Store(hn::Sqrt(position2), d, errors2[0]);
    hn::Store(hn::Sqrt(rotation2), d, errors2[1]);
    for (int lane = 0; lane < lanes; ++lane) {
      errors[begin + lane] = {errors2[0][lane], errors2[1][lane]};
    }
    for (int j = 0; j < joints; ++j) {
      hn::Store(q[j], d, column);
      for (int lane = 0; lane < lanes; ++lane) rows[(begin + lane) * joints + j] = column[lane];
    }
  }
}

IkKernel kernel() { return &solve_ik; }

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace mneme::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
MNEME_EXPORT(IkKernel, ik_kernel, kernel)
#endif
