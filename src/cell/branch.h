// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Branches of inverse kinematics over a box of tasks.
#pragma once

#include "mneme/cell.h"
#include "mneme/collision.h"

#include "goal/link_chain.h"
#include "cell/task_frame.h"

#include <vector>

namespace mneme::internal {

/// Configurations q0 + response y, with y by Newton's method for each pose.
struct Branch {
  JointVector q0;
  Response response;
};

/// Coefficients and rests of models are multiples of it, radians or metres: short in files.
inline constexpr double kShiftStep = 1.0 / 262144;

/// Rounds `q` to kPathStep, so that kernel, query and file have the same number.
[[nodiscard]] Branch make_branch(const LinkChain& chain, const JointVector& q);

/// Moves `q` within its branch from the task `from` to `to`. False if Newton's method fails in one
/// of `steps` equal steps.
[[nodiscard]] bool follow(const LinkChain& chain, const TaskFrame& frame, const CellTask& from,
                          const CellTask& to, int steps, JointVector& q);

/// `bends`: inverse kinematics fails in the box, or is too far from a quadratic.
enum class FitFault { none, limits, bends };

/// Room of a joint to its limits, as a multiple of what a box needs.
struct LimitSlack {
  double ratio = 1e9;
  int joint = 0;
};

/// Fits a quadratic to a branch over boxes of tasks.
class BranchFitter {
 public:
  /// Refers to its arguments.
  BranchFitter(const LinkChain& chain, const TaskFrame& frame);

  /// Writes the model of `branch` over the box, as a change from q0. Its `rest` exceeds the error
  /// at many samples; a task with a larger error is refused when it is asked for, so that it is no
  /// matter of safety.
  [[nodiscard]] FitFault fit(const TaskBox& box, const Branch& branch, GoalShift& shift) const;
  /// Motion of the joints per half width of the box, to first order: a column per parameter.
  [[nodiscard]] Eigen::MatrixXd slopes(const TaskBox& box, const Branch& branch) const;
  /// That of the joint with the least.
  [[nodiscard]] LimitSlack slack(const JointVector& q, const Eigen::MatrixXd& slopes) const;
  /// Larger is better: room to the limits, little motion.
  [[nodiscard]] double rate(const TaskBox& box, const JointVector& q) const;
  /// Values in [-1, 1] that stand for a box: corners, then random ones.
  [[nodiscard]] const std::vector<std::vector<double>>& probes() const { return probes_; }

 private:
  /// Moves `q`, within q + span(response), until the link is at `pose`.
  [[nodiscard]] bool solve(const Transform& pose, const Branch& branch, JointVector& q) const;

  const LinkChain& chain_;
  const TaskFrame& frame_;
  int parameters_;
  std::vector<std::vector<double>> nodes_, probes_;
  std::size_t checks_ = 0;  ///< models are checked at this number of probes
  Eigen::MatrixXd solver_;  // from values at the nodes to coefficients
};

}  // namespace mneme::internal
