// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Kinematics of one link in double precision, and Newton's method on a branch of its inverse.
#pragma once

#include "mneme/problem.h"
#include "mneme/robot.h"

#include <Eigen/Dense>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace mneme::internal {

inline constexpr int kMostChainJoints = 16;

using JointVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostChainJoints, 1>;
using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMostChainJoints>;
/// Joint motions by the link's twist: motion first, then rotation, in the root's frame.
using Response = Eigen::Matrix<double, Eigen::Dynamic, 6, 0, kMostChainJoints, 6>;
/// Motion in the root's frame, then rotation as axis times angle.
using Twist = Eigen::Matrix<double, 6, 1>;

/// Returns the twist from one pose to another.
[[nodiscard]] Twist difference(const Transform& from, const Transform& to);

[[nodiscard]] inline JointVector to_vector(const Configuration& q) {
  return Eigen::Map<const Eigen::VectorXd>(q.data(), static_cast<Eigen::Index>(q.size()));
}
[[nodiscard]] inline Configuration to_configuration(const JointVector& q) {
  return {q.data(), q.data() + q.size()};
}

class LinkChain {
 public:
  /// With a free axis, a joint without limits is added that turns the link about this axis. Errors:
  /// no such link; more joints than kMostChainJoints; fewer than six that move the link.
  [[nodiscard]] static Result<LinkChain> make(const Robot& robot, const std::string& link,
                                              std::optional<Axis> free_axis = {});

  [[nodiscard]] int joint_count() const { return static_cast<int>(lower_.size()); }
  /// Number of joints that move the link, with that of the free axis.
  [[nodiscard]] int moving_count() const { return moving_count_; }
  /// The link's pose at `q`. Writes its Jacobian unless that is null.
  [[nodiscard]] Transform place(const JointVector& q, Jacobian* jacobian = nullptr) const;

  /// The response of least joint motion at `q`; joints near their limits move less.
  [[nodiscard]] Response response(const JointVector& q) const;
  /// The same from the Jacobian at `q`. The joints whose bits are set in `locked` do not move.
  /// `damping` is added to the squares of twists: a planar arm, which has not all twists, needs it.
  [[nodiscard]] Response response(const JointVector& q, const Jacobian& jacobian,
                                  std::uint32_t locked, double damping) const;
  /// Columns of the same span: enough for reach(), and cheaper.
  [[nodiscard]] Response directions(const JointVector& q) const;
  /// Moves `q` within q + span(response) until the link is at `pose`, to within `near`, metres.
  /// False if that fails within `steps`.
  [[nodiscard]] bool reach(const Transform& pose, const Response& response, int steps, double near,
                           JointVector& q) const;

  /// The same by the chord method, without Jacobians: faster near the configuration of `response`.
  /// False as soon as an error does not halve.
  [[nodiscard]] bool approach(const Transform& pose, const Response& response, double near,
                              JointVector& q) const;

  /// Bounds on a straight motion of the joints, with time from 0 to 1.
  struct MotionBounds {
    double jerk = 0;  ///< of the link's origin: length of its third derivative, metres
    double turn = 0;  ///< rate at which the link turns, radians
  };
  /// A vector that k joints turn at the rates w_i has an n-th derivative of at most
  /// (|w_1| + ... + |w_k|)^n times its length.
  [[nodiscard]] MotionBounds bounds(const JointVector& from, const JointVector& to) const;

  [[nodiscard]] bool wraps(int joint) const { return wraps_[static_cast<std::size_t>(joint)]; }
  [[nodiscard]] const JointVector& lower() const { return lower_; }  ///< infinite if it wraps
  [[nodiscard]] const JointVector& upper() const { return upper_; }
  [[nodiscard]] bool keeps_limits(const JointVector& q) const {
    return (q.array() >= lower_.array()).all() && (q.array() <= upper_.array()).all();
  }

 private:
  LinkChain() = default;
  /// The transposed Jacobian; joints near their limits or in `locked` count for less or nothing.
  [[nodiscard]] Response directions(const JointVector& q, const Jacobian& jacobian,
                                    std::uint32_t locked) const;
  /// A joint after a fixed transform; its axis is z of its frame.
  struct Step {
    Transform fixed;
    int joint = 0;
    double rate = 1, offset = 0;
    bool is_prismatic = false;
  };
  /// Adds a step with this axis after `fixed`. Returns the fixed transform that follows.
  Transform add_step(const Transform& fixed, const Vec3& axis, Step step);
  void set_limits(const Robot& robot, int count);

  std::vector<Step> steps_;
  Transform tip_;
  JointVector lower_, upper_;
  std::vector<bool> wraps_;
  int moving_count_ = 0;
};

}  // namespace mneme::internal
