// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Damped least squares in the joints: how points move with them, and the system to be solved.
#if defined(MNEME_COLLISION_LEAST_SQUARES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MNEME_COLLISION_LEAST_SQUARES_INL_H_
#undef MNEME_COLLISION_LEAST_SQUARES_INL_H_
#else
#define MNEME_COLLISION_LEAST_SQUARES_INL_H_
#endif

#include <algorithm>

#include "collision/forward_kinematics-inl.h"
#include "tables/tables.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mneme::internal {
namespace HWY_NAMESPACE {

/// How a point of `frame` moves with the joints that carry it, and how the frame turns if `turns`
/// is not null; their number.
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
    // A joint that others mimic moves several frames.
    const bool is_known = place < count;
    slopes[place] = is_known ? slopes[place] + slope : slope;
    if (turns != nullptr) turns[place] = is_known ? turns[place] + turn : turn;
    joint[place] = row.joint;
    count = std::max(count, place + 1);
  }
  return count;
}

/// The normal equations of least squares in the joints, one system per lane.
class NormalEquations {
 public:
  /// Damped towards `wish`.
  HWY_INLINE void reset(int size, V damping, const V* wish) {
    size_ = size;
    for (int i = 0; i < size; ++i) {
      for (int k = 0; k <= i; ++k) at(i, k) = hn::Zero(Tag());
      at(i, i) = damping;
      right_[i] = hn::Mul(damping, wish[i]);
    }
  }

  /// Adds the squares of `slopes` x = `error`: of `count` joints, a row or three of them per point.
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

  /// By Cholesky's method, in place.
  HWY_INLINE void solve(V* x) {
    for (int i = 0; i < size_; ++i) {
      for (int k = 0; k <= i; ++k) {
        V sum = at(i, k);
        for (int j = 0; j < k; ++j) sum = hn::NegMulAdd(at(i, j), at(k, j), sum);
        // The inverse of the diagonal stands in its place.
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

#endif  // MNEME_COLLISION_LEAST_SQUARES_INL_H_
