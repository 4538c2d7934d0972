// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The search over branches of inverse kinematics along a line.
#pragma once

#include "mneme/goal.h"
#include "mneme/line.h"

#include "line/line_tracker.h"

#include <optional>
#include <vector>

namespace mneme::internal {

/// A tree of states: follows each start configuration along the line. Where all of them end early
/// and joints are redundant, branches grow towards configurations that reach farther.
class LineSearch {
 public:
  /// Refers to tracker and checker. `start` is the region of the link's poses at the line's start.
  LineSearch(LineTracker& tracker, const CollisionChecker& checker, const PoseGoal& start,
             const LineSettings& settings);

  /// With `may_add_starts`, further start configurations are sampled, too.
  void run(const std::vector<JointVector>& starts, bool may_add_starts);

  /// The path to the farthest state, or nothing without a start.
  [[nodiscard]] LinePath farthest() const;
  /// The whole paths.
  [[nodiscard]] std::vector<LinePath> whole() const;
  /// Why the farthest path ends.
  [[nodiscard]] const LineStop& stop() const { return stop_; }
  [[nodiscard]] int steps() const { return steps_; }
  [[nodiscard]] bool is_timed_out() const { return is_timed_out_; }
  [[nodiscard]] bool is_cancelled() const { return is_cancelled_; }

  /// Returns `q` with the joint of a free axis such that the link's pose is that at `s`.
  [[nodiscard]] JointVector with_free_axis(const Configuration& q, double s) const;

 private:
  struct Node {
    LineState state;
    int parent = -1;
  };
  [[nodiscard]] const LineState& at(int node) const {
    return nodes_[static_cast<std::size_t>(node)].state;
  }
  [[nodiscard]] bool is_over();
  [[nodiscard]] bool has_enough() const;
  /// True if the line's link, or one fixed to it, is in contact with an obstacle where the farthest
  /// branch ends: then no branch gets farther.
  [[nodiscard]] bool is_link_blocked();
  int add(const LineState& state, int parent);
  /// How a branch grows: to the share `until` of the line, towards `goal` if it is not null.
  struct Growth {
    double until = 1;
    LineCheck check = LineCheck::proof;
    double gain = 1;  ///< of the drift away from limits
    const JointVector* goal = nullptr;
  };
  /// Follows the line from a node. Returns the last node.
  int extend(int node, const Growth& growth);
  /// Follows the line to its end by kinematics alone, then proves all steps at once. Returns the
  /// last node, or `root` if either fails.
  int extend_at_once(int root);
  [[nodiscard]] JointVector drift(const LineState& from, const Growth& growth) const;
  /// Proves the path to a node. Returns its last node that is proven.
  int prove(int node);
  /// Notes why a branch ends at `s`, if none got farther. At the same place a plain step, without a
  /// goal, tells most.
  void note(const LineStop& stop, double s, bool is_plain);
  /// Keeps the path to the end of the line if it is proven, and its start new.
  void take_whole(int node);
  [[nodiscard]] int root_of(int node) const;
  void explore(bool may_add_starts);
  /// The share of the line at which round `i` samples configurations.
  [[nodiscard]] double choose_place(int i, bool may_add_starts);
  void grow_towards(const JointVector& goal, double s);
  /// Free configurations at the share `s`.
  [[nodiscard]] std::vector<JointVector> sample_states(double s);
  /// The node from which the least motion per share of the line leads to `goal` at `s`.
  [[nodiscard]] int find_nearest(const JointVector& goal, double s) const;
  [[nodiscard]] JointVector motion(const JointVector& from, const JointVector& to) const;
  [[nodiscard]] LinePath path_to(int node) const;

  LineTracker& tracker_;
  const CollisionChecker& checker_;
  PoseGoal goal_;
  std::optional<InverseKinematics> kinematics_;  ///< made when it is needed
  LineSettings settings_;
  Stopwatch stopwatch_;
  Rng rng_;
  std::vector<Node> nodes_;
  std::vector<int> whole_;  ///< last nodes of whole paths
  int farthest_ = -1;
  LineStop stop_;
  double stop_s_ = -1;                ///< where it is
  std::vector<std::string> carried_;  ///< links that are fixed to the line's link
  double examined_s_ = -1;            ///< the stop of is_link_blocked_
  bool is_link_blocked_ = false;
  int steps_ = 0;
  bool is_timed_out_ = false, is_cancelled_ = false;
};

}  // namespace mneme::internal
