// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Compiled once per instruction set. A vector holds one configuration per lane.
#include "collision/collision_kernels.h"

#include <algorithm>
#include <array>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "collision/collision_kernels.cpp"  // NOLINT
#include "hwy/foreach_target.h"

#include "collision/pair_distance-inl.h"
#include "simd/dispatch.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mneme::internal {
namespace HWY_NAMESPACE {
namespace {

/// A pose per lane, by columns.
struct Pose {
  V3 x, y, z, p;
};

HWY_INLINE V3 transform_vector(const Pose& pose, const float* v) {
  // Most of a robot's offsets lie along one axis; the branches are the same for all states.
  V3 result = {hn::Zero(Tag()), hn::Zero(Tag()), hn::Zero(Tag())};
  if (v[0] != 0) result = mul_add(splat(v[0]), pose.x, result);
  if (v[1] != 0) result = mul_add(splat(v[1]), pose.y, result);
  if (v[2] != 0) result = mul_add(splat(v[2]), pose.z, result);
  return result;
}

HWY_INLINE V3 transform_point(const Pose& pose, const float* point) {
  return pose.p + transform_vector(pose, point);
}

/// The columns of parent * rotation, for a row-major rotation.
HWY_INLINE Pose rotated(const Pose& parent, const float* r) {
  const auto column = [&](int i) {
    return mul_add(
        splat(r[i]), parent.x,
        mul_add(splat(r[3 + i]), parent.y,
                {hn::Mul(splat(r[6 + i]), parent.z.x), hn::Mul(splat(r[6 + i]), parent.z.y),
                 hn::Mul(splat(r[6 + i]), parent.z.z)}));
  };
  return {column(0), column(1), column(2), parent.p};
}

HWY_INLINE Pose identity_pose() {
  const V zero = hn::Zero(Tag()), one = splat(1.0f);
  return {{one, zero, zero}, {zero, one, zero}, {zero, zero, one}, {zero, zero, zero}};
}

HWY_INLINE void turn_about_z(Pose& pose, V angle) {
  V s, c;
  sin_cos(angle, s, c);
  const V3 x = pose.x, y = pose.y;
  pose.x = {hn::MulAdd(c, x.x, hn::Mul(s, y.x)), hn::MulAdd(c, x.y, hn::Mul(s, y.y)),
            hn::MulAdd(c, x.z, hn::Mul(s, y.z))};
  pose.y = {hn::MulSub(c, y.x, hn::Mul(s, x.x)), hn::MulSub(c, y.y, hn::Mul(s, x.y)),
            hn::MulSub(c, y.z, hn::Mul(s, x.z))};
}

/// Forward kinematics of all frames for the joint values `q`.
HWY_INLINE void pose_frames(const RobotTables& robot, const V* HWY_RESTRICT q,
                            Pose* HWY_RESTRICT poses) {
  const Pose root = identity_pose();
  for (size_t i = 0; i < robot.frames.size(); ++i) {
    const FrameRow& frame = robot.frames[i];
    const Pose& parent = frame.parent < 0 ? root : poses[frame.parent];
    Pose pose = frame.is_rotated ? rotated(parent, frame.rotation) : parent;
    pose.p = transform_point(parent, frame.translation);
    if (frame.is_prismatic) {
      pose.p = mul_add(q[frame.joint], pose.z, pose.p);
    } else {
      turn_about_z(pose, q[frame.joint]);
    }
    poses[i] = pose;
  }
}

/// What is hit so far. With `kIsMotion`, one hit in any lane settles the question; otherwise all
/// lanes must be hit before the rest can be skipped.
template <bool kIsMotion>
struct Verdict {
  // A default member initialiser would be compiled for the baseline instruction set.
  HWY_INLINE Verdict() : hit(hn::MaskFromVec(hn::Zero(Tag()))) {}

  M hit;

  HWY_INLINE bool add(M mask) {
    if constexpr (kIsMotion) {
      hit = mask;
      return !hn::AllFalse(Tag(), mask);
    } else {
      hit = hn::Or(hit, mask);
      return hn::AllTrue(Tag(), hit);
    }
  }
};

template <bool kIsMotion>
class StateChecker {
 public:
  StateChecker(const RobotTables& robot, const SceneTables& scene, float margin)
      : robot_(robot), scene_(scene), margin_(margin) {}

  /// True as soon as the verdict is settled.
  bool check(const V* q, Verdict<kIsMotion>& verdict) {
    pose_frames(robot_, q, poses_);
    for (size_t i = 0; i < robot_.links.size(); ++i) {
      const LinkRow& link = robot_.links[i];
      centers_[i] = transform_point(poses_[link.frame], link.center);
      if (hits_scene(link, centers_[i], verdict)) return true;
    }
    for (const auto& [first, second] : robot_.pairs) {
      const LinkRow& a = robot_.links[first];
      const LinkRow& b = robot_.links[second];
      const float reach = a.radius + b.radius;
      const V distance2 = squared_norm(centers_[first] - centers_[second]);
      if (hn::AllFalse(Tag(), hn::Lt(distance2, splat(reach * reach)))) continue;
      if (hits_link(a, poses_[a.frame], b, poses_[b.frame], verdict)) return true;
    }
    const Pose root = identity_pose();
    for (const auto& [first, second] : robot_.fixed_pairs) {
      const LinkRow& a = robot_.links[first];
      const LinkRow& b = robot_.fixed_links[second];
      const float reach = a.radius + b.radius;
      const V distance2 = squared_norm(centers_[first] - splat(b.center));
      if (hn::AllFalse(Tag(), hn::Lt(distance2, splat(reach * reach)))) continue;
      if (hits_link(a, poses_[a.frame], b, root, verdict)) return true;
    }
    return false;
  }

 private:
  HWY_INLINE bool is_near(const V3& center, float radius, const float* other,
                          float other_radius) const {
    const float reach = radius + margin_ + other_radius;
    const V distance2 = squared_norm(center - splat(other));
    return !hn::AllFalse(Tag(), hn::Lt(distance2, splat(reach * reach)));
  }

  HWY_INLINE bool hits_scene(const LinkRow& link, const V3& center,
                             Verdict<kIsMotion>& verdict) const {
    const Pose& pose = poses_[link.frame];
    for (const SphereRow& sphere : scene_.spheres) {
      if (!is_near(center, link.radius, sphere.center, sphere.radius)) continue;
      const V3 c = splat(sphere.center);
      const auto to_point = [&](const V3& p) { return squared_norm(p - c); };
      const auto to_segment = [&](const Segment& s) { return point_segment(c, s); };
      if (hits(link, pose, sphere.radius + margin_, to_point, to_segment, verdict)) return true;
    }
    for (const BoxRow& box : scene_.boxes) {
      if (!is_near(center, link.radius, box.center, box.bounding_radius)) continue;
      const auto to_point = [&](const V3& p) { return point_box(p, box); };
      const auto to_segment = [&](const Segment& s) { return segment_box(s, box); };
      if (hits(link, pose, margin_, to_point, to_segment, verdict)) return true;
    }
    for (const CapsuleRow& capsule : scene_.capsules) {
      const Segment axis = make_segment(splat(capsule.a), splat(capsule.b));
      const float reach = link.radius + margin_ + capsule.radius;
      if (hn::AllFalse(Tag(), hn::Lt(point_segment(center, axis), splat(reach * reach)))) continue;
      const auto to_point = [&](const V3& p) { return point_segment(p, axis); };
      const auto to_segment = [&](const Segment& s) { return segment_segment(s, axis); };
      if (hits(link, pose, capsule.radius + margin_, to_point, to_segment, verdict)) return true;
    }
    return false;
  }

  /// The shapes of a link against something with a core of radius `radius`, given squared distances
  /// to it.
  template <class ToPoint, class ToSegment>
  HWY_INLINE bool hits(const LinkRow& link, const Pose& pose, float radius, const ToPoint& to_point,
                       const ToSegment& to_segment, Verdict<kIsMotion>& verdict) const {
    for (int i = link.sphere_begin; i < link.sphere_end; ++i) {
      const SphereRow& own = robot_.spheres[i];
      const float reach = own.radius + radius;
      const V distance2 = to_point(transform_point(pose, own.center));
      if (verdict.add(hn::Lt(distance2, splat(reach * reach)))) return true;
    }
    for (int i = link.capsule_begin; i < link.capsule_end; ++i) {
      const CapsuleRow& own = robot_.capsules[i];
      const float reach = own.radius + radius;
      const V distance2 = to_segment(posed(pose, own));
      if (verdict.add(hn::Lt(distance2, splat(reach * reach)))) return true;
    }
    return false;
  }

  HWY_INLINE Segment posed(const Pose& pose, const CapsuleRow& capsule) const {
    return make_segment(transform_point(pose, capsule.a), transform_point(pose, capsule.b));
  }

  HWY_INLINE bool hits_link(const LinkRow& a, const Pose& pose_a, const LinkRow& b,
                            const Pose& pose_b, Verdict<kIsMotion>& verdict) const {
    for (int i = a.sphere_begin; i < a.sphere_end; ++i) {
      const V3 center = transform_point(pose_a, robot_.spheres[i].center);
      const auto to_point = [&](const V3& p) { return squared_norm(p - center); };
      const auto to_segment = [&](const Segment& s) { return point_segment(center, s); };
      if (hits(b, pose_b, robot_.spheres[i].radius, to_point, to_segment, verdict)) return true;
    }
    for (int i = a.capsule_begin; i < a.capsule_end; ++i) {
      const Segment axis = posed(pose_a, robot_.capsules[i]);
      const auto to_point = [&](const V3& p) { return point_segment(p, axis); };
      const auto to_segment = [&](const Segment& s) { return segment_segment(s, axis); };
      if (hits(b, pose_b, robot_.capsules[i].radius, to_point, to_segment, verdict)) return true;
    }
    return false;
  }

  const RobotTables& robot_;
  const SceneTables& scene_;
  float margin_;
  Pose poses_[kMaxRows];
  V3 centers_[kMaxRows];
};

bool is_motion_free(const RobotTables& robot, const SceneTables& scene, const float* from,
                    const float* delta, int states, float margin, std::uint64_t& states_checked) {
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int blocks = std::max(1, (states + lanes - 1) / lanes);
  const float step = 1.0f / static_cast<float>(blocks * lanes);
  StateChecker<true> checker(robot, scene, margin);
  Verdict<true> verdict;
  V q[kMaxRows];
  // Lane i looks at the i-th stretch of the motion. Each block looks at one state of every stretch;
  // the first one at their ends, because a motion is blocked at its far end most often.
  const V stretch = hn::Mul(hn::Iota(d, 0.0f), splat(static_cast<float>(blocks)));
  for (int block = blocks; block > 0; --block) {
    const V fraction = hn::Mul(hn::Add(stretch, splat(static_cast<float>(block))), splat(step));
    for (int j = 0; j < robot.joint_count; ++j) {
      q[j] = hn::MulAdd(fraction, splat(delta[j]), splat(from[j]));
    }
    states_checked += static_cast<std::uint64_t>(lanes);
    if (checker.check(q, verdict)) return false;
  }
  return true;
}

void check_states(const RobotTables& robot, const SceneTables& scene, const float* states,
                  int count, float margin, std::uint8_t* is_free) {
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  StateChecker<false> checker(robot, scene, margin);
  V q[kMaxRows];
  HWY_ALIGN float column[HWY_MAX_BYTES / sizeof(float)];
  for (int begin = 0; begin < count; begin += lanes) {
    for (int j = 0; j < robot.joint_count; ++j) {
      for (int lane = 0; lane < lanes; ++lane) {
        const int row = std::min(begin + lane, count - 1);
        column[lane] = states[row * robot.joint_count + j];
      }
      q[j] = hn::Load(d, column);
    }
    Verdict<false> verdict;
    checker.check(q, verdict);
    hn::Store(hn::IfThenElseZero(verdict.hit, splat(1.0f)), d, column);
    for (int lane = 0; lane < lanes && begin + lane < count; ++lane) {
      is_free[begin + lane] = column[lane] == 0.0f;
    }
  }
}

const CollisionKernels* kernels() {
  static const CollisionKernels table = {static_cast<int>(hn::Lanes(Tag())), &is_motion_free,
                                         &check_states};
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
