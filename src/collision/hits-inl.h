// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Groups of the robot's shapes, one pose per lane, and what they hit.
#if defined(MNEME_COLLISION_HITS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MNEME_COLLISION_HITS_INL_H_
#undef MNEME_COLLISION_HITS_INL_H_
#else
#define MNEME_COLLISION_HITS_INL_H_
#endif

#include "collision/forward_kinematics-inl.h"
#include "collision/margins-inl.h"
#include "tables/tables.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mneme::internal {
namespace HWY_NAMESPACE {

HWY_INLINE M no_hit() { return hn::MaskFromVec(hn::Zero(Tag())); }

/// What is hit so far. With `kIsMotion`, one hit in any lane settles the question; otherwise all
/// lanes must be hit before the rest can be skipped.
template <bool kIsMotion>
struct Verdict {
  // A default member initialiser would be compiled for the baseline instruction set.
  HWY_INLINE Verdict() : hit(no_hit()) {}

  M hit;

  /// 1 if `mask` holds in a lane that is not hit yet, otherwise 0: to be counted, because a branch
  /// would not be predicted. Whatever is near lanes that are hit alone need not be looked at.
  [[nodiscard]] HWY_INLINE int is_any_open(M mask) const {
    return !hn::AllFalse(Tag(), kIsMotion ? mask : hn::AndNot(hit, mask));
  }
  HWY_INLINE bool add(M mask) {
    hit = hn::Or(hit, mask);
    return kIsMotion ? !hn::AllFalse(Tag(), hit) : hn::AllTrue(Tag(), hit);
  }
};

/// The spheres of a group.
struct PosedSpheres {
  V3 centers[kGroupSize];
};

HWY_INLINE PosedSpheres posed(const RobotTables& robot, const GroupRow& group, const Pose& pose) {
  PosedSpheres result;
  for (int i = 0; i < kGroupSize; ++i) {
    result.centers[i] = transform_point(pose, robot.spheres[group.begin + i].center);
  }
  return result;
}

HWY_INLINE Segment posed(const CapsuleRow& capsule, const Pose& pose) {
  const V zero = hn::Zero(Tag());
  return {add_sparse(pose, capsule.a, pose.origin),
          add_sparse(pose, capsule.along, {zero, zero, zero}), splat(capsule.inverse_length2)};
}

/// Where a sphere of the group comes closer than `extra` to something, given squared distances.
template <class Margin, class Distance2>
HWY_INLINE M find_hits(const RobotTables& robot, const GroupRow& group, const PosedSpheres& spheres,
                       Margin extra, const Distance2& distance2) {
  M hit = no_hit();
  for (int i = 0; i < kGroupSize; ++i) {
    const V reach = lanes_of(sum(robot.spheres[group.begin + i].radius, extra));
    hit = hn::Or(hit, hn::Lt(distance2(spheres.centers[i]), hn::Mul(reach, reach)));
  }
  return hit;
}

}  // namespace HWY_NAMESPACE
}  // namespace mneme::internal
HWY_AFTER_NAMESPACE();

#endif  // MNEME_COLLISION_HITS_INL_H_
