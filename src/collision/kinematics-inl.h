// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Poses of a robot's frames and damped least squares, one configuration per lane.
#if defined(MNEME_COLLISION_KINEMATICS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MNEME_COLLISION_KINEMATICS_INL_H_
#undef MNEME_COLLISION_KINEMATICS_INL_H_
#else
#define MNEME_COLLISION_KINEMATICS_INL_H_
#endif

#include <algorithm>

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

/// Adds a vector to `to`. Branches on coordinates that are 0, as most of frames and capsules are:
/// the branches are the same for all states, and so are predicted.
HWY_INLINE V3 add_sparse(const Pose& pose, const float* offset, V3 to) {
  for (int i = 0; i < 3; ++i) {
    if (offset[i] != 0) to = mul_add(splat(offset[i]), pose.axes[i], to);
  }
  return to;
}

/// Writes the pose at the origin with a row-major rotation. A pose that is returned would be built
/// in memory and copied, for every motion.
HWY_INLINE void set_rotation(const float* r, Pose& pose) {
  for (int i = 0; i < 3; ++i) pose.axes[i] = {splat(r[i]), splat(r[3 + i]), splat(r[6 + i])};
  const V zero = hn::Zero(Tag());
  pose.origin = {zero, zero, zero};
}

/// The axes of a frame in its parent's, at joint value 0.
HWY_INLINE void turn_axes(const Pose& parent, const FrameRow& frame, Pose& pose) {
  for (int i = 0; i < 3; ++i) {
    if (frame.turn == Turn::general) {
      const float* r = frame.rotation + i;
      pose.axes[i] = mul_add(splat(r[0]), parent.axes[0],
                             mul_add(splat(r[3]), parent.axes[1], splat(r[6]) * parent.axes[2]));
    } else if (frame.turn == Turn::permutation) {
      const V3& source = parent.axes[frame.source[i]];
      pose.axes[i] = frame.is_reversed[i] ? negated(source) : source;
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

/// Writes poses 1, 2, ... of the frames at the joint values `q`. Pose 0, of the root, is given.
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

/// Writes the derivatives of a point of `frame` by the joints that carry it, and, unless `turns` is
/// null, the frame's angular velocities. Returns the number of these joints.
HWY_INLINE int find_slopes(const RobotTables& robot, const Pose* poses, int frame, const V3& point,
                           int* joint, V3* slopes, V3* turns = nullptr) {
  const V zero = hn::Zero(Tag());
  int count = 0;
  for (; frame > 0; frame = robot.frames[frame - 1].parent) {
    const FrameRow& row = robot.frames[frame - 1];
    const Pose& pose = poses[frame];
    const V rate = splat(row.multiplier);
    const V3 axis = rate * pose.axes[2];
    const V3 slope = row.is_prismatic ? axis : cross(axis, point - pose.origin);
    const V3 turn = row.is_prismatic ? V3{zero, zero, zero} : axis;
    int place = 0;
    while (place < count && joint[place] != row.joint) ++place;
    // A joint with mimics moves several frames.
    const bool is_known = place < count;
    slopes[place] = is_known ? slopes[place] + slope : slope;
    if (turns != nullptr) turns[place] = is_known ? turns[place] + turn : turn;
    joint[place] = row.joint;
    count = std::max(count, place + 1);
  }
  return count;
}

/// Normal equations of damped least squares in the joints, one system per lane.
class NormalEquations {
 public:
  /// Begins `size` equations, damped towards `wish`.
  HWY_INLINE void reset(int size, V damping, const V* wish) {
    size_ = size;
    for (int i = 0; i < size; ++i) {
      for (int k = 0; k <= i; ++k) at(i, k) = hn::Zero(Tag());
      at(i, i) = damping;
      right_[i] = hn::Mul(damping, wish[i]);
    }
  }

  /// Adds the squares of `slopes` x - `error` for `count` joints: one row, or three for a V3.
  template <class Slope, class Error>
  HWY_INLINE void add(const int* joint, const Slope* slopes, int count, const Error& error) {
    for (int a = 0; a < count; ++a) {
      const int i = joint[a];
      right_[i] = accumulate(slopes[a], error, right_[i]);
      for (int b = 0; b <= a; ++b) {
        V& sum = joint[b] <= i ? at(i, joint[b]) : at(joint[b], i);
        sum = accumulate(slopes[a], slopes[b], sum);
      }
    }
  }

  /// Writes the solution by Cholesky's method, in place.
  HWY_INLINE void solve(V* x) {
    for (int i = 0; i < size_; ++i) {
      for (int k = 0; k <= i; ++k) {
        V sum = at(i, k);
        for (int j = 0; j < k; ++j) sum = hn::NegMulAdd(at(i, j), at(k, j), sum);
        // The diagonal holds its inverse.
        at(i, k) = i == k ? hn::Div(splat(1.0f), hn::Sqrt(hn::Max(sum, splat(1e-9f))))
                          : hn::Mul(sum, at(k, k));
      }
      V sum = right_[i];
      for (int j = 0; j < i; ++j) sum = hn::NegMulAdd(at(i, j), x[j], sum);
      x[i] = hn::Mul(sum, at(i, i));
    }
    for (int i = size_ - 1; i >= 0; --i) {
      V sum = x[i];
      for (int j = i + 1; j < size_; ++j) sum = hn::NegMulAdd(at(j, i), x[j], sum);
      x[i] = hn::Mul(sum, at(i, i));
    }
  }

 private:
  static HWY_INLINE V accumulate(V a, V b, V sum) { return hn::MulAdd(a, b, sum); }
  static HWY_INLINE V accumulate(const V3& a, const V3& b, V sum) {
    return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::MulAdd(a.z, b.z, sum)));
  }
  HWY_INLINE V& at(int row, int column) { return matrix_[row * (row + 1) / 2 + column]; }

  int size_ = 0;
  V matrix_[kMostWalkingJoints * (kMostWalkingJoints + 1) / 2];
  V right_[kMostWalkingJoints];
};

}  // namespace HWY_NAMESPACE
}  // namespace mneme::internal
HWY_AFTER_NAMESPACE();

#endif  // MNEME_COLLISION_KINEMATICS_INL_H_
