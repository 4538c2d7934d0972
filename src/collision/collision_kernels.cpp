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

#include "collision/forward_kinematics-inl.h"
#include "collision/obstacle_distance-inl.h"
#include "simd/dispatch.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mneme::internal {
namespace HWY_NAMESPACE {
namespace {

constexpr int kLanes = HWY_LANES(float);

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

HWY_INLINE bool is_any_below(V distance2, float reach) {
  return !hn::AllFalse(Tag(), hn::Lt(distance2, splat(reach * reach)));
}

/// The shapes of a group, one pose per lane.
struct PosedGroup {
  V3 spheres[kMaxGroupSize];
  Segment capsules[kMaxGroupSize];
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
    for (int i = 0; i < robot_.moving_count; ++i) {
      const BodyRow& body = robot_.bodies[i];
      centers_[i] = transform_point(poses_[body.frame], body.ball.center);
      store_extent(centers_[i], lower_[i], upper_[i]);
    }
    for (int i = 0; i < robot_.moving_count; ++i) {
      if (hits_scene(i, verdict)) return true;
    }
    for (const BodyPairRow& pair : robot_.body_pairs) {
      const float reach =
          robot_.bodies[pair.first].ball.radius + robot_.bodies[pair.second].ball.radius;
      if (!is_any_below(squared_norm(centers_[pair.first] - centers_[pair.second]), reach)) {
        continue;
      }
      if (hits_body(pair, verdict)) return true;
    }
    return false;
  }

 private:
  /// One bit for each of the obstacles from `begin` whose box meets that of the body's lanes.
  HWY_INLINE unsigned find_overlaps(int body, size_t begin) const {
    const Tag d;
    const float reach = robot_.bodies[body].ball.radius + margin_;
    M overlap = hn::MaskFromVec(hn::Zero(d));
    for (int axis = 0; axis < 3; ++axis) {
      const M is_below =
          hn::Le(hn::LoadU(d, &scene_.lower[axis][begin]), splat(upper_[body][axis] + reach));
      const M is_above =
          hn::Ge(hn::LoadU(d, &scene_.upper[axis][begin]), splat(lower_[body][axis] - reach));
      const M both = hn::And(is_below, is_above);
      overlap = axis == 0 ? both : hn::And(overlap, both);
    }
    uint8_t bytes[8];
    hn::StoreMaskBits(d, overlap, bytes);
    if constexpr (kLanes == 16) return bytes[0] | unsigned{bytes[1]} << 8;
    return bytes[0] & ((1u << kLanes) - 1);
  }

  HWY_INLINE bool hits_scene(int index, Verdict<kIsMotion>& verdict) const {
    const BodyRow& body = robot_.bodies[index];
    const bool is_single = body.group_end - body.group_begin == 1;
    for (size_t begin = 0; begin < scene_.lower[0].size(); begin += kLanes) {
      const ObstacleRow* near[kLanes];
      int count = 0;
      for (unsigned bits = find_overlaps(index, begin); bits != 0; bits &= bits - 1) {
        near[count++] = &scene_.obstacles[begin + static_cast<size_t>(__builtin_ctz(bits))];
      }
      if (!is_single) count = keep_near(centers_[index], body.ball.radius, near, count, near);
      if (count > 0 && hits_obstacles(index, near, count, verdict)) return true;
    }
    return false;
  }

  /// Copies the obstacles that a ball meets in any lane to `kept`; returns their number.
  HWY_INLINE int keep_near(const V3& center, float radius, const ObstacleRow* const* near,
                           int count, const ObstacleRow** kept) const {
    int kept_count = 0;
    for (int i = 0; i < count; ++i) {
      const float reach = radius + margin_ + near[i]->rounding;
      kept[kept_count] = near[i];
      kept_count += with_distance(
          *near[i], [&](const auto& distance2) { return is_any_below(distance2(center), reach); });
    }
    return kept_count;
  }

  HWY_NOINLINE bool hits_obstacles(int index, const ObstacleRow* const* near, int count,
                                   Verdict<kIsMotion>& verdict) const {
    const BodyRow& body = robot_.bodies[index];
    const Pose& pose = poses_[body.frame];
    PosedGroup posed;
    for (int g = body.group_begin; g < body.group_end; ++g) {
      const GroupRow& group = robot_.groups[g];
      const ObstacleRow* kept[kLanes];
      const int kept_count =
          keep_near(transform_point(pose, group.ball.center), group.ball.radius, near, count, kept);
      if (kept_count == 0) continue;
      pose_group(group, pose, posed);
      for (int i = 0; i < kept_count; ++i) {
        const float extra = kept[i]->rounding + margin_;
        const bool is_settled = with_distance(*kept[i], [&](const auto& distance2) {
          return hits_shapes(group, posed, extra, distance2, verdict);
        });
        if (is_settled) return true;
      }
    }
    return false;
  }

  HWY_INLINE void pose_group(const GroupRow& group, const Pose& pose, PosedGroup& posed) const {
    for (int i = group.sphere_begin; i < group.sphere_end; ++i) {
      posed.spheres[i - group.sphere_begin] = transform_point(pose, robot_.spheres[i].center);
    }
    for (int i = group.capsule_begin; i < group.capsule_end; ++i) {
      const CapsuleRow& capsule = robot_.capsules[i];
      posed.capsules[i - group.capsule_begin] =
          make_segment(transform_point(pose, capsule.a), transform_point(pose, capsule.b));
    }
  }

  /// The shapes of a group against something with a core and a radius around it, given squared
  /// distances to the core.
  template <class Distance2>
  HWY_INLINE bool hits_shapes(const GroupRow& group, const PosedGroup& posed, float radius,
                              const Distance2& distance2, Verdict<kIsMotion>& verdict) const {
    M hit = hn::MaskFromVec(hn::Zero(Tag()));
    for (int i = group.sphere_begin; i < group.sphere_end; ++i) {
      const float reach = robot_.spheres[i].radius + radius;
      const V d2 = distance2(posed.spheres[i - group.sphere_begin]);
      hit = hn::Or(hit, hn::Lt(d2, splat(reach * reach)));
    }
    for (int i = group.capsule_begin; i < group.capsule_end; ++i) {
      const float reach = robot_.capsules[i].radius + radius;
      const V d2 = distance2(posed.capsules[i - group.capsule_begin]);
      hit = hn::Or(hit, hn::Lt(d2, splat(reach * reach)));
    }
    return verdict.add(hit);
  }

  HWY_NOINLINE bool hits_body(const BodyPairRow& pair, Verdict<kIsMotion>& verdict) const {
    const Pose& pose = poses_[robot_.bodies[pair.first].frame];
    const Ball& other = robot_.bodies[pair.second].ball;
    const V3& other_center = centers_[pair.second];
    for (int i = pair.begin; i < pair.end; ++i) {
      const GroupPairRow& groups = robot_.group_pairs[i];
      const Ball& ball = robot_.groups[groups.first].ball;
      const V3 center = transform_point(pose, ball.center);
      if (!is_any_below(squared_norm(center - other_center), ball.radius + other.radius)) continue;
      if (hits_groups(groups, center, pose, poses_[robot_.bodies[pair.second].frame], verdict)) {
        return true;
      }
    }
    return false;
  }

  HWY_INLINE bool hits_groups(const GroupPairRow& pair, const V3& center, const Pose& pose,
                              const Pose& other_pose, Verdict<kIsMotion>& verdict) const {
    const GroupRow& first = robot_.groups[pair.first];
    PosedGroup posed, other_posed;
    bool is_posed = false;
    for (int i = pair.second_begin; i < pair.second_end; ++i) {
      const GroupRow& second = robot_.groups[i];
      const V3 other_center = transform_point(other_pose, second.ball.center);
      const float reach = first.ball.radius + second.ball.radius;
      if (!is_any_below(squared_norm(center - other_center), reach)) continue;
      if (!is_posed) pose_group(first, pose, posed);
      is_posed = true;
      pose_group(second, other_pose, other_posed);
      if (hits_group(first, posed, second, other_posed, verdict)) return true;
    }
    return false;
  }

  HWY_INLINE bool hits_group(const GroupRow& first, const PosedGroup& posed, const GroupRow& second,
                             const PosedGroup& other, Verdict<kIsMotion>& verdict) const {
    for (int i = first.sphere_begin; i < first.sphere_end; ++i) {
      const V3& center = posed.spheres[i - first.sphere_begin];
      const auto distance2 = Overloaded{[&](const V3& p) { return squared_norm(p - center); },
                                        [&](const Segment& s) { return point_segment(center, s); }};
      if (hits_shapes(second, other, robot_.spheres[i].radius, distance2, verdict)) return true;
    }
    for (int i = first.capsule_begin; i < first.capsule_end; ++i) {
      const Segment& axis = posed.capsules[i - first.capsule_begin];
      const auto distance2 = Overloaded{[&](const V3& p) { return point_segment(p, axis); },
                                        [&](const Segment& s) { return segment_segment(s, axis); }};
      if (hits_shapes(second, other, robot_.capsules[i].radius, distance2, verdict)) return true;
    }
    return false;
  }

  template <class... Functions>
  struct Overloaded : Functions... {
    using Functions::operator()...;
  };
  template <class... Functions>
  Overloaded(Functions...) -> Overloaded<Functions...>;

  const RobotTables& robot_;
  const SceneTables& scene_;
  float margin_;
  Pose poses_[kMaxFrames + 1];
  V3 centers_[kMaxBodies];
  HWY_ALIGN float lower_[kMaxFrames][HWY_LANES(float) < 4 ? 4 : HWY_LANES(float)];
  HWY_ALIGN float upper_[kMaxFrames][HWY_LANES(float) < 4 ? 4 : HWY_LANES(float)];
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
