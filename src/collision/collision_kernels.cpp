// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Compiled once per instruction set. A vector holds one configuration per lane.
//
// What is far apart costs little: bodies are held against obstacles 16 at a time by the box that a
// body sweeps in all lanes, then by their bounding balls lane by lane, then group by group; only a
// group whose ball hits has its shapes posed.
#include "collision/collision_kernels.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "collision/collision_kernels.cpp"  // NOLINT
#include "hwy/foreach_target.h"

#include "collision/distance-inl.h"
#include "collision/forward_kinematics-inl.h"
#include "collision/scene_boxes-inl.h"
#include "simd/dispatch.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mneme::internal {
namespace HWY_NAMESPACE {
namespace {

/// What is hit so far. With `kIsMotion`, one hit in any lane settles the question; otherwise all
/// lanes must be hit before the rest can be skipped.
template <bool kIsMotion>
struct Verdict {
  // A default member initialiser would be compiled for the baseline instruction set.
  HWY_INLINE Verdict() : hit(hn::MaskFromVec(hn::Zero(Tag()))) {}

  M hit;

  HWY_INLINE bool add(M mask) {
    hit = hn::Or(hit, mask);
    return kIsMotion ? !hn::AllFalse(Tag(), hit) : hn::AllTrue(Tag(), hit);
  }
};

HWY_INLINE float squared(float x) { return x * x; }

/// So many bodies go through the coarse tests before the finer ones: more would put off contacts of
/// the tips, fewer would wait for each other.
constexpr int kBatch = 4;
/// What passed a coarse test is listed before the finer one.
constexpr int kListSize = 64;

/// The spheres of a group, one pose per lane.
struct PosedSpheres {
  V3 centers[kGroupSize];
};

template <bool kIsMotion>
class StateChecker {
 public:
  HWY_INLINE StateChecker(const RobotTables& robot, const SceneTables& scene, float margin)
      : robot_(robot), scene_(scene), margin_(margin) {
    poses_[0] = splat_rotation(scene.rotation);
    for (size_t i = robot.moving_count; i < robot.bodies.size(); ++i) {
      centers_[i] = transform_point(poses_[0], robot.bodies[i].ball.center);
    }
  }

  /// True as soon as the verdict is settled.
  HWY_INLINE bool check(const V* q, Verdict<kIsMotion>& verdict) {
    pose_frames(robot_, q, poses_);
    for (int begin = 0; begin < robot_.moving_count; begin += kBatch) {
      const int end = std::min(begin + kBatch, robot_.moving_count);
      for (int i = begin; i < end; ++i) {
        const BodyRow& body = robot_.bodies[i];
        centers_[i] = transform_point(poses_[body.frame], body.ball.center);
        extents_[i].set(centers_[i]);
      }
      if (hits_scene(begin, end, verdict)) return true;
    }
    return hits_self(verdict);
  }

 private:
  HWY_INLINE bool hits_scene(int first, int last, Verdict<kIsMotion>& verdict) const {
    for (size_t begin = 0; begin < scene_.lower[0].size(); begin += kLanes) {
      int near[kBatch];
      unsigned overlaps[kBatch];
      int count = 0;
      for (int i = first; i < last; ++i) {
        near[count] = i;
        overlaps[count] =
            find_overlaps(scene_, extents_[i], robot_.bodies[i].ball.radius + margin_, begin);
        count += overlaps[count] != 0;
      }
      for (int i = 0; i < count; ++i) {
        if (hits_obstacles(near[i], begin, overlaps[i], verdict)) return true;
      }
    }
    return false;
  }

  HWY_NOINLINE bool hits_obstacles(int index, size_t begin, unsigned bits,
                                   Verdict<kIsMotion>& verdict) const {
    const BodyRow& body = robot_.bodies[index];
    const float reach2 = squared(body.ball.radius + margin_);
    const ObstacleRow* near[kLanes];
    int count = 0;
    for (; bits != 0; bits &= bits - 1) {
      const size_t i = begin + static_cast<size_t>(__builtin_ctz(bits));
      near[count] = &scene_.obstacles[i];
      count += is_any_below(distance2_to_bounds(scene_, centers_[index], i), reach2);
    }
    for (int g = body.group_begin; count > 0 && g < body.group_end; ++g) {
      if (hits_obstacles(robot_.groups[g], poses_[body.frame], near, count, verdict)) return true;
    }
    return false;
  }

  HWY_INLINE bool hits_obstacles(const GroupRow& group, const Pose& pose,
                                 const ObstacleRow* const* near, int count,
                                 Verdict<kIsMotion>& verdict) const {
    if (group.is_capsule) {
      const CapsuleRow& capsule = robot_.capsules[group.begin];
      return hits_obstacles(capsule, posed(capsule, pose), near, count, verdict);
    }
    const V3 center = transform_point(pose, group.ball.center);
    PosedSpheres spheres;
    bool is_posed = false;
    for (int i = 0; i < count; ++i) {
      const float extra = near[i]->rounding + margin_;
      const float reach2 = squared(group.ball.radius + extra);
      const M hit = with_distance(*near[i], [&](const auto& distance2) {
        if (!is_any_below(distance2(center), reach2)) return hn::MaskFromVec(hn::Zero(Tag()));
        if (!is_posed) spheres = posed(group, pose);
        is_posed = true;
        return find_hits(group, spheres, extra, distance2);
      });
      if (verdict.add(hit)) return true;
    }
    return false;
  }

  HWY_NOINLINE bool hits_obstacles(const CapsuleRow& capsule, const Segment& axis,
                                   const ObstacleRow* const* near, int count,
                                   Verdict<kIsMotion>& verdict) const {
    for (int i = 0; i < count; ++i) {
      const float reach = capsule.radius + near[i]->rounding + margin_;
      const M hit = with_distance(*near[i], [&](const auto& distance2) {
        return hn::Lt(distance2(axis), splat(squared(reach)));
      });
      if (verdict.add(hit)) return true;
    }
    return false;
  }

  HWY_INLINE PosedSpheres posed(const GroupRow& group, const Pose& pose) const {
    PosedSpheres result;
    for (int i = 0; i < kGroupSize; ++i) {
      result.centers[i] = transform_point(pose, robot_.spheres[group.begin + i].center);
    }
    return result;
  }

  HWY_INLINE Segment posed(const CapsuleRow& capsule, const Pose& pose) const {
    const V zero = hn::Zero(Tag());
    return {add_sparse(pose, capsule.a, pose.origin),
            add_sparse(pose, capsule.along, {zero, zero, zero}), splat(capsule.inverse_length2)};
  }

  /// Where a sphere of the group comes closer than `extra` to something, given squared distances.
  template <class Distance2>
  HWY_INLINE M find_hits(const GroupRow& group, const PosedSpheres& spheres, float extra,
                         const Distance2& distance2) const {
    M hit = hn::MaskFromVec(hn::Zero(Tag()));
    for (int i = 0; i < kGroupSize; ++i) {
      const V reach = splat(robot_.spheres[group.begin + i].radius + extra);
      hit = hn::Or(hit, hn::Lt(distance2(spheres.centers[i]), hn::Mul(reach, reach)));
    }
    return hit;
  }

  HWY_INLINE bool hits_self(Verdict<kIsMotion>& verdict) const {
    const int pair_count = static_cast<int>(robot_.body_pairs.size());
    for (int begin = 0; begin < pair_count; begin += kListSize) {
      const int end = std::min(begin + kListSize, pair_count);
      int near[kListSize];
      int count = 0;
      for (int i = begin; i < end; ++i) {
        const BodyPairRow& pair = robot_.body_pairs[i];
        near[count] = i;
        count +=
            is_any_below(squared_norm(centers_[pair.first] - centers_[pair.second]), pair.reach2);
      }
      for (int i = 0; i < count; ++i) {
        if (hits_body(robot_.body_pairs[near[i]], verdict)) return true;
      }
    }
    return false;
  }

  HWY_NOINLINE bool hits_body(const BodyPairRow& pair, Verdict<kIsMotion>& verdict) const {
    const Pose& pose = poses_[robot_.bodies[pair.first].frame];
    const Pose& other_pose = poses_[robot_.bodies[pair.second].frame];
    if (pair.is_single) {
      const GroupPairRow& groups = robot_.group_pairs[pair.begin];
      return verdict.add(find_hits(robot_.groups[groups.first], pose,
                                   robot_.groups[groups.second_begin], other_pose));
    }
    const float other_radius = robot_.bodies[pair.second].ball.radius;
    const V3& other_center = centers_[pair.second];
    for (int begin = pair.begin; begin < pair.end; begin += kListSize) {
      const int end = std::min(begin + kListSize, pair.end);
      int near[kListSize];
      int count = 0;
      for (int i = begin; i < end; ++i) {
        const Ball& ball = robot_.groups[robot_.group_pairs[i].first].ball;
        near[count] = i;
        count += is_any_below(squared_norm(transform_point(pose, ball.center) - other_center),
                              squared(ball.radius + other_radius));
      }
      for (int i = 0; i < count; ++i) {
        if (hits_groups(robot_.group_pairs[near[i]], pose, other_pose, verdict)) return true;
      }
    }
    return false;
  }

  HWY_INLINE bool hits_groups(const GroupPairRow& pair, const Pose& pose, const Pose& other_pose,
                              Verdict<kIsMotion>& verdict) const {
    const GroupRow& first = robot_.groups[pair.first];
    const V3 center = transform_point(pose, first.ball.center);
    for (int begin = pair.second_begin; begin < pair.second_end; begin += kListSize) {
      const int end = std::min(begin + kListSize, pair.second_end);
      int near[kListSize];
      int count = 0;
      for (int i = begin; i < end; ++i) {
        const Ball& ball = robot_.groups[i].ball;
        near[count] = i;
        count += is_any_below(squared_norm(transform_point(other_pose, ball.center) - center),
                              squared(ball.radius + first.ball.radius));
      }
      for (int i = 0; i < count; ++i) {
        const GroupRow& second = robot_.groups[near[i]];
        if (verdict.add(find_hits(first, pose, second, other_pose))) return true;
      }
    }
    return false;
  }

  HWY_INLINE M find_hits(const GroupRow& first, const Pose& pose, const GroupRow& second,
                         const Pose& other_pose) const {
    if (first.is_capsule) return find_capsule_hits(first, pose, second, other_pose);
    if (second.is_capsule) return find_capsule_hits(second, other_pose, first, pose);
    return find_sphere_hits(first, pose, second, other_pose);
  }

  HWY_INLINE M find_sphere_hits(const GroupRow& first, const Pose& pose, const GroupRow& second,
                                const Pose& other_pose) const {
    const PosedSpheres spheres = posed(first, pose), others = posed(second, other_pose);
    M hit = hn::MaskFromVec(hn::Zero(Tag()));
    for (int i = 0; i < kGroupSize; ++i) {
      const auto distance2 = [&](const V3& p) { return squared_norm(p - spheres.centers[i]); };
      const float radius = robot_.spheres[first.begin + i].radius;
      hit = hn::Or(hit, find_hits(second, others, radius, distance2));
    }
    return hit;
  }

  /// The first group is a capsule.
  HWY_NOINLINE M find_capsule_hits(const GroupRow& first, const Pose& pose, const GroupRow& second,
                                   const Pose& other_pose) const {
    const CapsuleRow& capsule = robot_.capsules[first.begin];
    const Segment axis = posed(capsule, pose);
    if (!second.is_capsule) {
      return find_hits(second, posed(second, other_pose), capsule.radius,
                       [&](const V3& p) { return point_segment(p, axis); });
    }
    const CapsuleRow& other = robot_.capsules[second.begin];
    const V distance2 = segment_segment(axis, posed(other, other_pose));
    return hn::Lt(distance2, splat(squared(capsule.radius + other.radius)));
  }

  const RobotTables& robot_;
  const SceneTables& scene_;
  float margin_;
  Pose poses_[kMaxFrames + 1];
  V3 centers_[kMaxBodies];
  Extent extents_[kMaxBodies];
};

bool is_motion_free(const RobotTables& robot, const SceneTables& scene, const float* from,
                    const float* delta, int states, float margin, std::uint64_t& states_checked) {
  const Tag d;
  const int blocks = std::max(1, (states + kLanes - 1) / kLanes);
  const float step = 1.0f / static_cast<float>(blocks * kLanes);
  StateChecker<true> checker(robot, scene, margin);
  V q[kMaxFrames];
  // Lane i looks at the i-th stretch of the motion. Each block looks at one state of every stretch;
  // the first one at their ends, because a motion is blocked at its far end most often.
  const V stretch = hn::Mul(hn::Iota(d, 0.0f), splat(static_cast<float>(blocks)));
  for (int block = blocks; block > 0; --block) {
    const V fraction = hn::Mul(hn::Add(stretch, splat(static_cast<float>(block))), splat(step));
    for (int j = 0; j < robot.joint_count; ++j) {
      q[j] = hn::MulAdd(fraction, splat(delta[j]), splat(from[j]));
    }
    states_checked += static_cast<std::uint64_t>(kLanes);
    Verdict<true> verdict;
    if (checker.check(q, verdict)) return false;
  }
  return true;
}

void check_states(const RobotTables& robot, const SceneTables& scene, const float* states,
                  int count, float margin, std::uint8_t* is_free) {
  const Tag d;
  const hn::RebindToSigned<Tag> di;
  StateChecker<false> checker(robot, scene, margin);
  V q[kMaxFrames];
  HWY_ALIGN float column[kLanes];
  for (int begin = 0; begin < count; begin += kLanes) {
    // Lanes beyond the last row repeat it.
    const auto row = hn::Min(hn::Iota(di, begin), hn::Set(di, count - 1));
    const auto first = hn::Mul(row, hn::Set(di, robot.joint_count));
    for (int j = 0; j < robot.joint_count; ++j) q[j] = hn::GatherIndex(d, states + j, first);
    Verdict<false> verdict;
    checker.check(q, verdict);
    hn::Store(hn::IfThenElseZero(verdict.hit, splat(1.0f)), d, column);
    for (int lane = 0; lane < kLanes && begin + lane < count; ++lane) {
      is_free[begin + lane] = column[lane] == 0.0f;
    }
  }
}

const CollisionKernels* kernels() {
  static const CollisionKernels table = {kLanes, &is_motion_free, &check_states};
  return &table;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace mneme::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace mneme::internal {

HWY_EXPORT(kernels);

const CollisionKernels& collision_kernels(Isa isa) { return *MNEME_DISPATCH(kernels, isa); }

}  // namespace mneme::internal
#endif  // HWY_ONCE
