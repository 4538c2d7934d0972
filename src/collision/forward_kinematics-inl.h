// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Poses of a robot's frames, a configuration per lane.
#if defined(MNEME_COLLISION_FORWARD_KINEMATICS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MNEME_COLLISION_FORWARD_KINEMATICS_INL_H_
#undef MNEME_COLLISION_FORWARD_KINEMATICS_INL_H_
#else
#define MNEME_COLLISION_FORWARD_KINEMATICS_INL_H_
#endif

#include "tables/tables.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mneme::internal {
namespace HWY_NAMESPACE {

/// A pose per lane: the frame's axes and origin.
struct Pose {
  V3 axes[3];
  V3 origin;
};

HWY_INLINE V3 transform_point(const Pose& pose, const float* point) {
  return mul_add(
      splat(point[0]), pose.axes[0],
      mul_add(splat(point[1]), pose.axes[1], mul_add(splat(point[2]), pose.axes[2], pose.origin)));
}

/// `to` and a vector, most of whose coordinates are 0, as those of frames and capsules are: the
/// branches are the same for all states.
HWY_INLINE V3 add_sparse(const Pose& pose, const float* offset, V3 to) {
  for (int i = 0; i < 3; ++i) {
    if (offset[i] != 0) to = mul_add(splat(offset[i]), pose.axes[i], to);
  }
  return to;
}

/// A pose without an offset, turned by a row-major rotation.
HWY_INLINE Pose splat_rotation(const float* r) {
  const V zero = hn::Zero(Tag());
  return {{{splat(r[0]), splat(r[3]), splat(r[6])},
           {splat(r[1]), splat(r[4]), splat(r[7])},
           {splat(r[2]), splat(r[5]), splat(r[8])}},
          {zero, zero, zero}};
}

HWY_INLINE V3 with_sign(const V3& a, float sign) {
  const V bits = splat(sign);
  return {hn::Xor(a.x, bits), hn::Xor(a.y, bits), hn::Xor(a.z, bits)};
}

/// The axes of a frame in its parent's, at joint value 0.
HWY_INLINE void turn_axes(const Pose& parent, const FrameRow& frame, Pose& pose) {
  for (int i = 0; i < 3; ++i) {
    if (frame.turn == Turn::general) {
      const float* r = frame.rotation + i;
      pose.axes[i] = mul_add(splat(r[0]), parent.axes[0],
                             mul_add(splat(r[3]), parent.axes[1], splat(r[6]) * parent.axes[2]));
    } else if (frame.turn == Turn::permutation) {
      pose.axes[i] = with_sign(parent.axes[frame.source[i]], frame.sign[i]);
    } else {
      pose.axes[i] = parent.axes[i];
    }
  }
}

/// Turns a pose about its z axis.
HWY_INLINE void turn_about_z(Pose& pose, V sine, V cosine) {
  const V3 x = pose.axes[0], y = pose.axes[1];
  pose.axes[0] = mul_add(cosine, x, sine * y);
  pose.axes[1] = mul_sub(cosine, y, sine * x);
}

/// Poses 1, 2, ... of the frames for the joint values `q`; pose 0, of the root, is given.
HWY_INLINE void pose_frames(const RobotTables& robot, const V* HWY_RESTRICT q,
                            Pose* HWY_RESTRICT poses) {
  for (size_t i = 0; i < robot.frames.size(); ++i) {
    const FrameRow& frame = robot.frames[i];
    const Pose& parent = poses[frame.parent];
    const V value = hn::MulAdd(splat(frame.multiplier), q[frame.joint], splat(frame.offset));
    Pose pose;
    turn_axes(parent, frame, pose);
    pose.origin = add_sparse(parent, frame.translation, parent.origin);
    if (frame.is_prismatic) {
      pose.origin = mul_add(value, pose.axes[2], pose.origin);
    } else {
      V sine, cosine;
      sin_cos(value, sine, cosine);
      turn_about_z(pose, sine, cosine);
    }
    poses[i + 1] = pose;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace mneme::internal
HWY_AFTER_NAMESPACE();

#endif  // MNEME_COLLISION_FORWARD_KINEMATICS_INL_H_
