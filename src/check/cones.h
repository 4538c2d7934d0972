// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Orientation constraints as planners ask for them, in their single precision.
#pragma once

#include "mneme/check.h"

#include "robot/joint_space.h"

#include <optional>
#include <span>
#include <vector>

namespace mneme::internal {

/// The joints that turn a link, and the cone that its axis is to stay in. A direction needs no
/// positions: a state costs a rotation of one vector per joint.
class Cone {
 public:
  /// The constraint passes describe_fault().
  Cone(const Robot& robot, const OrientationConstraint& constraint);

  /// Cosine of the tilt at `from` + `share` * `delta`; `delta` may be null.
  [[nodiscard]] double cosine(const float* from, const float* delta = nullptr,
                              double share = 0) const;
  /// The same at `q`, and its derivatives by the joints, which are added to `gradient`.
  [[nodiscard]] double cosine_and_gradient(const float* q, std::span<double> gradient) const;
  /// Radians that the axis turns at most where the joints move by `delta`.
  [[nodiscard]] double longest_turn(const float* delta) const;
  /// True if the motion stays within the cone, narrowed by `slack` radians. Along a motion that
  /// turns the axis by L at most the cosine's second derivative is no larger than L^2, so that it
  /// lies above a parabola through its values at both ends: stretches are halved until all those
  /// parabolas stay above the cone's cosine, or one is shorter than a milliradian.
  [[nodiscard]] bool contains_motion(const float* from, const float* delta, double slack) const;
  [[nodiscard]] double angle() const { return angle_; }

 private:
  struct Turn {
    Eigen::Matrix3d before;  ///< from the joint's frame to that of the turn before
    Vec3 axis;
    int joint;  ///< of the group
    double rate, offset;
  };

  Vec3 axis_, up_;
  double angle_;
  std::vector<Turn> turns_;  ///< from the root to the link
};

/// All constraints of a robot's motions. Const and parallel-safe.
class Cones {
 public:
  Cones(const Robot& robot, std::span<const OrientationConstraint> constraints);

  [[nodiscard]] std::span<const OrientationConstraint> constraints() const { return constraints_; }
  // As CollisionChecker documents them.
  [[nodiscard]] bool contain(std::span<const float> q) const;
  [[nodiscard]] bool contain_motion(std::span<const float> from, std::span<const float> to,
                                    std::span<const float> bow) const;
  bool project(std::span<float> q) const;

 private:
  /// A step towards the inside of `cone`; false if no joint leads there.
  bool lean_back(const Cone& cone, std::span<float> q) const;

  JointSpace space_;
  std::vector<OrientationConstraint> constraints_;
  std::vector<Cone> cones_;
};

}  // namespace mneme::internal
