// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Two bodies at the ends of a chain of joints, and whether they stay apart while it moves.
#pragma once

#include "mneme/robot.h"

#include "check/link_distances.h"
#include "geometry/swept_solids.h"

#include <optional>
#include <span>
#include <vector>

namespace mneme::internal {

/// The joints between a link and another one, or the root frame.
class JointChain {
 public:
  /// A driven joint about, or along, the z axis of `mount`.
  struct Step {
    Transform mount;  ///< in the frame in which the previous step ends
    bool is_prismatic = false;
    int joint = 0;  ///< index into the group
    double rate = 1, offset = 0;
  };

  /// From link `a` to link `b`; without `b` to the root frame.
  JointChain(const Robot& robot, int a, std::optional<int> b);

  [[nodiscard]] std::span<const Step> steps() const { return steps_; }
  /// Pose of the end in the frame of the last step.
  [[nodiscard]] const Transform& last() const { return last_; }

 private:
  void add_motion(const Robot& robot, int index, double sign);

  std::vector<Step> steps_;
  Transform last_;
};

/// The motion of a chain's end seen from its begin, while joints move from `from` by `delta`.
class ChainMotion final : public BodyMotion {
 public:
  /// The motion is a single state if `delta` is empty or moves no joint of the chain.
  ChainMotion(const JointChain& chain, std::span<const float> from, std::span<const float> delta);

 private:
  using Step = JointChain::Step;

  [[nodiscard]] double rate_of(const Step& step) const;
  [[nodiscard]] double value_of(const Step& step, double share) const;
  [[nodiscard]] MovingPose at(double share) const override;
  void set_bounds();
  void add(const Step& step, double& length, double& turns, MotionBound& bound) const;

  const JointChain& chain_;
  std::span<const float> from_, delta_;
};

/// A link and another one, or a link and shapes in the frame in which the chain ends.
struct SolidPair {
  SolidPair(JointChain chain, ExactLink link, ExactLink other);
  SolidPair(JointChain chain, ExactLink link, std::vector<Shape> shapes, double margin = 0);

  /// True if both stay `extra` metres and the margin apart on the motion. Motions that come closer
  /// by 5e-5 m may fail.
  [[nodiscard]] bool stays_apart(ChainMotion& motion, double extra) const;
  /// As stays_apart() by bounds on the motion as a whole, at the cost of a state.
  [[nodiscard]] bool stays_apart_as_whole(ChainMotion& motion, double extra) const;
  /// True if the surfaces stay so far apart at states, two `finest` shares of the motion from each
  /// other. States of which motion bounds tell so are left out. Does not look for enclosure.
  [[nodiscard]] bool is_apart_at_states(ChainMotion& motion, double extra, double finest) const;

  JointChain chain;
  ExactLink link;
  std::optional<ExactLink> other;  ///< without it there are shapes
  std::vector<Shape> shapes;
  std::vector<SweptSolid> solids, others;  ///< of `link`, and of the other body
  double margin = 0;

 private:
  template <class AreApart>
  [[nodiscard]] bool all_pairs(const AreApart& are_apart) const;
  [[nodiscard]] bool may_be_inside(const Transform& X_AB) const;
};

}  // namespace mneme::internal
