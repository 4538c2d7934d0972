// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Compiled once per instruction set. A vector holds one candidate per lane.
//
// Damped least squares (Wampler, DOI 10.1109/TSMC.1986.289285; Nakamura and Hanafusa, DOI
// 10.1115/1.3143764). Its rows are points of a limb that are pulled to a target, and balls of the
// robot that are pushed from an obstacle along its normal.
#include "collision/collision_kernels.h"

#include <cassert>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "collision/walk_kernel.cpp"  // NOLINT
#include "hwy/foreach_target.h"

#include "tables/distance-inl.h"
#include "collision/kinematics-inl.h"
#include "simd/dispatch.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mneme::internal {
namespace HWY_NAMESPACE {
namespace {

/// Rounds of damped least squares per step: after one, pushed bodies are still in contact.
constexpr int kRounds = 3;
/// Damping per square radian, in squares of the limb's length.
constexpr float kDamping = 3e-5f;

HWY_INLINE float squared(float x) { return x * x; }

class Walker {
 public:
  HWY_INLINE Walker(const RobotTables& robot, const SceneTables& scene, const WalkRequest& request,
                    CheckCounters& counters)
      : robot_(robot), scene_(scene), request_(request), counters_(counters) {
    set_rotation(scene.rotation, poses_[0]);
  }

  HWY_INLINE void walk(const V3& jitter, V* q) {
    const int joints = robot_.joint_count;
    V wish[kMostWalkingJoints], change[kMostWalkingJoints];
    for (int round = 0; round < kRounds; ++round) {
      pose_frames(robot_, q, poses_);
      counters_.work += kLanes * kRoundWork + scan_work(scene_, robot_.moving_count);
      // Only once: later rounds only push.
      if (round == 0) set_targets(jitter);
      for (int j = 0; j < joints; ++j) {
        wish[j] = splat(round == 0 ? request_.drift[j] * request_.length : 0.0f);
      }
      equations_.reset(joints, splat(kDamping * squared(request_.limb->length)), wish);
      pull();
      push();
      equations_.solve(change);
      for (int j = 0; j < joints; ++j) {
        const V moved = hn::Add(q[j], change[j]);
        q[j] = hn::Max(splat(request_.lower[j]), hn::Min(splat(request_.upper[j]), moved));
      }
    }
  }

 private:
  [[nodiscard]] HWY_INLINE V3 limb_point(int i) const {
    const LimbPoint& point = request_.limb->points[i];
    return transform_point(poses_[point.frame], point.point);
  }

  /// Sets the target of each pulled point on the line to the next point of the limb.
  HWY_INLINE void set_targets(const V3& jitter) {
    V3 point = limb_point(0);
    for (int i = 0; i < request_.pulled_points; ++i) {
      const V3 next = limb_point(i + 1);
      const V3 direction = normalized(normalized(next - point) + jitter);
      targets_[i] = mul_add(splat(request_.length), direction, point);
      point = next;
    }
  }

  HWY_INLINE void pull() {
    for (int i = 0; i < request_.pulled_points; ++i) {
      const V3 point = limb_point(i);
      add_point(request_.limb->points[i].frame, point, targets_[i] - point);
    }
  }

  static HWY_INLINE V3 normalized(const V3& a) {
    const V length = hn::Sqrt(hn::Max(squared_norm(a), splat(1e-12f)));
    return hn::Div(splat(1.0f), length) * a;
  }

  HWY_INLINE void add_point(int frame, const V3& point, const V3& error) {
    int joint[kMaxFrames];
    V3 slopes[kMaxFrames];
    const int count = find_slopes(robot_, poses_, frame, point, joint, slopes);
    equations_.add(joint, slopes, count, error);
  }

  /// Asks the point to move by `error` along `direction`, which is 0 in unaffected lanes.
  HWY_INLINE void add_row(int frame, const V3& point, const V3& direction, V error) {
    int joint[kMaxFrames];
    V3 slopes[kMaxFrames];
    V along[kMaxFrames];
    const int count = find_slopes(robot_, poses_, frame, point, joint, slopes);
    for (int i = 0; i < count; ++i) along[i] = dot(direction, slopes[i]);
    equations_.add(joint, along, count, error);
  }

  HWY_INLINE void push() {
    for (int i = 0; i < robot_.moving_count; ++i) {
      const BodyRow& body = robot_.bodies[i];
      const V3 center = transform_point(poses_[body.frame], body.ball.center);
      const float reach = body.ball.radius + request_.clearance;
      Extent extent;
      extent.set(center, reach);
      for (size_t begin = 0; begin < scene_.lower[0].size(); begin += kLanes) {
        unsigned bits = find_overlaps(scene_, extent, begin);
        for (; bits != 0; bits &= bits - 1) {
          const size_t obstacle = begin + static_cast<size_t>(__builtin_ctz(bits));
          // Compound shapes push nothing: checks reject candidates in contact with them.
          if (scene_.obstacles[obstacle].kind != ObstacleKind::compound &&
              is_any_below(distance2_to_bounds(scene_, center, obstacle), reach * reach)) {
            push(body, obstacle);
          }
        }
      }
    }
  }

  /// The ball of a body that is deepest in an obstacle, lane by lane.
  struct Deepest {
    V3 center, normal;
    V clearance;

    HWY_INLINE void update(const ObstacleRow& row, const V3& p, float radius) {
      V3 direction;
      const V candidate = hn::Sub(clearance_of(row, p, direction), splat(radius));
      const M is_deeper = hn::Lt(candidate, clearance);
      clearance = hn::IfThenElse(is_deeper, candidate, clearance);
      center = choose(is_deeper, p, center);
      normal = choose(is_deeper, direction, normal);
    }
    static HWY_INLINE V3 choose(M mask, const V3& a, const V3& b) {
      return {hn::IfThenElse(mask, a.x, b.x), hn::IfThenElse(mask, a.y, b.y),
              hn::IfThenElse(mask, a.z, b.z)};
    }
  };

  HWY_NOINLINE void push(const BodyRow& body, size_t obstacle) {
    const Pose& pose = poses_[body.frame];
    const ObstacleRow& row = scene_.obstacles[obstacle];
    const V zero = hn::Zero(Tag());
    Deepest deepest{{zero, zero, zero}, {zero, zero, zero}, splat(request_.clearance)};
    counters_.work +=
        kLanes * kTestWork * static_cast<std::uint64_t>(body.group_end - body.group_begin);
    for (int g = body.group_begin; g < body.group_end; ++g) {
      if (!scene_.may_touch.empty() && scene_.may_group_touch(g, obstacle)) continue;
      const GroupRow& group = robot_.groups[g];
      const V3 center = transform_point(pose, group.ball.center);
      const float reach = group.ball.radius + request_.clearance;
      if (!is_any_below(distance2_to_bounds(scene_, center, obstacle), reach * reach)) continue;
      counters_.work += kLanes * kPushWork;
      if (group.is_capsule) {
        update_capsule(pose, robot_.capsules[group.begin], row, deepest);
        continue;
      }
      for (int i = 0; i < kGroupSize; ++i) {
        const Ball& ball = robot_.spheres[group.begin + i];
        deepest.update(row, transform_point(pose, ball.center), ball.radius);
      }
    }
    const V depth = hn::Sub(splat(request_.clearance), deepest.clearance);
    if (hn::AllTrue(Tag(), hn::Eq(depth, zero))) return;
    counters_.work += kLanes * kRowWork;
    add_row(body.frame, deepest.center, deepest.normal, depth);
  }

  /// Tries the ends of a capsule, its middle, and the point closest to the middle of the obstacle.
  /// A thin link may touch a long obstacle between them.
  HWY_INLINE void update_capsule(const Pose& pose, const CapsuleRow& capsule,
                                 const ObstacleRow& row, Deepest& deepest) const {
    const V3 a = transform_point(pose, capsule.a);
    const V zero = hn::Zero(Tag());
    const V3 along = add_sparse(pose, capsule.along, {zero, zero, zero});
    const V3 middle = mul_add(splat(0.5f), splat(row.along), splat(row.center));
    const V closest = clamp01(hn::Mul(dot(middle - a, along), splat(capsule.inverse_length2)));
    for (const V t : {zero, splat(0.5f), splat(1.0f), closest}) {
      deepest.update(row, mul_add(t, along, a), capsule.radius);
    }
  }

  const RobotTables& robot_;
  const SceneTables& scene_;
  const WalkRequest& request_;
  CheckCounters& counters_;
  Pose poses_[kMaxFrames + 1];
  V3 targets_[kMostLimbPoints];
  NormalEquations equations_;
};

void walk(const RobotTables& robot, const SceneTables& scene, const WalkRequest& request,
          float* candidates, CheckCounters& counters) {
  const Tag d;
  const hn::RebindToSigned<Tag> di;
  assert(robot.joint_count <= kMostWalkingJoints);
  assert(static_cast<size_t>(request.pulled_points) < request.limb->points.size());
  Walker walker(robot, scene, request, counters);
  V q[kMostWalkingJoints];
  HWY_ALIGN float column[kLanes];
  for (int begin = 0; begin < request.count; begin += kLanes) {
    // Lanes beyond the last candidate repeat it.
    const auto row = hn::Min(hn::Iota(di, begin), hn::Set(di, request.count - 1));
    const auto first = hn::Mul(row, hn::Set(di, 3));
    const auto from = hn::Mul(row, hn::Set(di, request.from_stride));
    for (int j = 0; j < robot.joint_count; ++j) q[j] = hn::GatherIndex(d, request.from + j, from);
    walker.walk(
        {hn::GatherIndex(d, request.jitter, first), hn::GatherIndex(d, request.jitter + 1, first),
         hn::GatherIndex(d, request.jitter + 2, first)},
        q);
    for (int j = 0; j < robot.joint_count; ++j) {
      hn::Store(q[j], d, column);
      for (int lane = 0; lane < kLanes && begin + lane < request.count; ++lane) {
        candidates[(begin + lane) * robot.joint_count + j] = column[lane];
      }
    }
  }
}

WalkKernel kernel() { return &walk; }

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace mneme::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
MNEME_EXPORT(WalkKernel, walk_kernel, kernel)
#endif
