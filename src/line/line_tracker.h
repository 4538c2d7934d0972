// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Steps along a line on one branch of inverse kinematics.
#pragma once

#include "mneme/path.h"

#include "goal/link_chain.h"
#include "line/line_segment.h"

#include <span>

namespace mneme::internal {

/// A waypoint on the line.
struct LineState {
  double s = 0;                           ///< share of the line
  JointVector q;                          ///< with the joint of a free axis
  double position = 0, rotation = 0;      ///< error of the link's pose at `q`, metres and radians
  double step = 0;                        ///< share of the line that the next step tries
  double off_line = 0, off_rotation = 0;  ///< bounds on the deviation since the last waypoint
  bool is_proven = true;                  ///< the motion to it is proven free
};

/// Why a branch ends.
struct LineStop {
  enum class Kind { none, kinematics, limit, contact, budget };
  Kind kind = Kind::none;
  int joint = -1;        ///< the joint at its limit
  JointVector from, to;  ///< the motion that is not possible
};

/// How thoroughly a step is checked.
enum class LineCheck {
  proof,       ///< The motion is proven free; steps are halved down to half a millimetre.
  states,      ///< Only states of the motion are checked; steps are given up early.
  kinematics,  ///< Contact is not looked for.
};

struct LineTolerances {
  double position = 0, rotation = 0;
};

/// Steps that keep the tolerances, the joint limits and the verification of motions.
class LineTracker {
 public:
  /// Refers to its arguments.
  LineTracker(const LinkChain& chain, const LineSegment& segment, const CollisionChecker& checker,
              const LineTolerances& tolerances);

  /// Returns the state at the start of the line, or of a part of it.
  [[nodiscard]] LineState begin(double s, const JointVector& q) const;
  /// Takes one step towards the share `until` of the line. `drift` is a motion of the joints per
  /// share of the line, of which the part is used that does not move the link. Writes `to` unless
  /// the step fails. Adds the number of attempts to `attempts`.
  [[nodiscard]] LineStop step(const LineState& from, double until, JointVector drift,
                              LineCheck check, LineState& to, int& attempts);
  /// True if the motion between two states of the line is proven free.
  [[nodiscard]] bool prove(const LineState& from, const LineState& to);
  /// True if all motions between consecutive states are proven free at once.
  [[nodiscard]] bool prove(std::span<const LineState> states);
  /// The drift that leads away from limits.
  [[nodiscard]] JointVector drift_from_limits(const JointVector& q) const;

  [[nodiscard]] const LinkChain& chain() const { return chain_; }
  [[nodiscard]] const LineSegment& segment() const { return segment_; }
  [[nodiscard]] CheckCounters& checks() { return checks_; }
  /// Number of joints beyond those that a pose needs: six, or three in a plane.
  [[nodiscard]] int redundancy() const { return redundancy_; }
  /// Brings `q` to the pose at `s`; false if Newton's method fails or limits are not kept.
  [[nodiscard]] bool settle(double s, JointVector& q) const;

 private:
  /// The kinematics of the state that a step starts from.
  struct Base {
    const LineState& from;
    Transform pose;
    Jacobian jacobian;
    Response response;
  };
  [[nodiscard]] LineStop attempt(const Base& base, double h, const JointVector& drift,
                                 LineCheck check, LineState& to, double& excess);
  /// Moves to.q to the pose at to.s.
  [[nodiscard]] bool correct(const Response& response, LineState& to) const;
  /// Bounds the deviation between both states. Returns it as a multiple of the tolerance.
  [[nodiscard]] double bound_deviation(const LineState& from, LineState& to) const;
  [[nodiscard]] bool is_free(const LineState& from, const LineState& to, LineCheck check);
  [[nodiscard]] bool has_free_states(const LineState& from, const LineState& to);
  [[nodiscard]] int find_violated_limit(const JointVector& q) const;

  const LinkChain& chain_;
  const LineSegment& segment_;
  const CollisionChecker& checker_;
  MotionVerifier verifier_;
  LineTolerances tolerances_;
  std::size_t joints_;  ///< of the robot's group
  int redundancy_;
  CheckCounters checks_;
};

}  // namespace mneme::internal
