// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Kinematics of one link in double precision, and Newton's method on a branch of its inverse.
#pragma once

#include "mneme/robot.h"

#include <Eigen/Dense>

#include <string>
#include <vector>

namespace mneme::internal {

inline constexpr int kMostCellJoints = 16;

using JointVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostCellJoints, 1>;
using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMostCellJoints>;
/// Joint motions by the link's twist: motion first, then rotation, in the root's frame.
using Response = Eigen::Matrix<double, Eigen::Dynamic, 6, 0, kMostCellJoints, 6>;

[[nodiscard]] inline JointVector to_vector(const Configuration& q) {
  return Eigen::Map<const Eigen::VectorXd>(q.data(), static_cast<Eigen::Index>(q.size()));
}
[[nodiscard]] inline Configuration to_configuration(const JointVector& q) {
  return {q.data(), q.data() + q.size()};
}

class LinkChain {
 public:
  /// Errors: no such link; more joints than kMostCellJoints; fewer than six that move the link.
  [[nodiscard]] static Result<LinkChain> make(const Robot& robot, const std::string& link);

  [[nodiscard]] int joint_count() const { return static_cast<int>(lower_.size()); }
  /// The link's pose at `q`. Writes its Jacobian unless that is null.
  [[nodiscard]] Transform place(const JointVector& q, Jacobian* jacobian = nullptr) const;

  /// The response of least joint motion at `q`; joints near their limits move less.
  [[nodiscard]] Response response(const JointVector& q) const;
  /// Moves `q` within q + span(response) until the link is at `pose`, to within 1e-7 m or `near`.
  /// False if that fails within `steps`.
  [[nodiscard]] bool reach(const Transform& pose, const Response& response, int steps, double near,
                           JointVector& q) const;

  [[nodiscard]] bool wraps(int joint) const { return wraps_[static_cast<std::size_t>(joint)]; }
  [[nodiscard]] const JointVector& lower() const { return lower_; }  ///< infinite if it wraps
  [[nodiscard]] const JointVector& upper() const { return upper_; }
  [[nodiscard]] bool keeps_limits(const JointVector& q) const {
    return (q.array() >= lower_.array()).all() && (q.array() <= upper_.array()).all();
  }

 private:
  LinkChain() = default;
  /// A joint after a fixed transform; its axis is z of its frame.
  struct Step {
    Transform fixed;
    int joint = 0;
    double rate = 1, offset = 0;
    bool is_prismatic = false;
  };
  std::vector<Step> steps_;
  Transform tip_;
  JointVector lower_, upper_;
  std::vector<bool> wraps_;
};

}  // namespace mneme::internal
