// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Orientation constraints on configurations of single precision, as planners use them.
#pragma once

#include "mneme/check.h"

#include "robot/joint_space.h"

#include <span>
#include <vector>

namespace mneme::internal {

/// The joints that turn a link, and the cone that its axis stays in. Cost of a state: a rotation of
/// one vector per joint.
class Cone {
 public:
  /// Precondition: describe_fault() returns nothing for the constraint.
  Cone(const Robot& robot, const OrientationConstraint& constraint);

  /// Cosine of the tilt at `from` + `share` * `delta`; `delta` may be null.
  [[nodiscard]] double cosine(const float* from, const float* delta = nullptr,
                              double share = 0) const;
  /// Cosine of the tilt at `q`. Adds its derivatives by the joints to `gradient`.
  [[nodiscard]] double cosine_and_gradient(const float* q, std::span<double> gradient) const;
  /// Bound on the turn of the axis, radians, while the joints move by `delta`.
  [[nodiscard]] double longest_turn(const float* delta) const;
  /// True if the motion stays within the cone, narrowed by `slack` radians. If the motion turns the
  /// axis by at most L, the second derivative of the cosine is at most L^2. The cosine then lies
  /// above a parabola through its values at both ends. Stretches are halved until every parabola
  /// stays above the cone's cosine. A stretch that turns the axis by less than a milliradian is not
  /// halved: the motion fails.
  [[nodiscard]] bool contains_motion(const float* from, const float* delta, double slack) const;
  [[nodiscard]] double angle() const { return angle_; }

 private:
  struct Turn {
    Eigen::Matrix3d before;  ///< from the joint's frame to the frame of the previous turn
    Vec3 axis;
    int joint;  ///< index into the group
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
  /// CollisionChecker::keeps_constraints and project document these.
  [[nodiscard]] bool contain(std::span<const float> q) const;
  [[nodiscard]] bool contain_motion(std::span<const float> from, std::span<const float> to,
                                    std::span<const float> bow) const;
  bool project(std::span<float> q) const;

 private:
  /// Takes a step towards the inside of `cone`; false if no joint leads there.
  bool lean_back(const Cone& cone, std::span<float> q) const;

  JointSpace space_;
  std::vector<OrientationConstraint> constraints_;
  std::vector<Cone> cones_;
};

}  // namespace mneme::internal
