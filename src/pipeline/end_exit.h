// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Motions out of contact at one end of a path.
#pragma once

#include "mneme/collision.h"
#include "mneme/goal.h"

#include "check/end_motions.h"

#include <optional>
#include <string>
#include <vector>

namespace mneme::internal {

enum class PathEnd { start, goal };

/// The contacts at an end of a path, and the motions that leave them.
class EndExit {
 public:
  /// `states`: of a motion that is checked, at least; 16 times as many where other links are near.
  /// `checker` must outlive this.
  EndExit(const CollisionChecker& checker, const EndTolerances& tolerances, PathEnd end, int states)
      : checker_(checker),
        motions_(checker.robot(), checker.scene(), checker.margin(), tolerances),
        is_start_(end == PathEnd::start),
        states_(states) {}

  /// Returns the contacts at `q`. A contact of spheres alone counts only if the exact geometry is
  /// nearer than `clearance`. Checks these pairs by exact geometry from now on.
  [[nodiscard]] std::vector<Touch> find_touches(const Configuration& q, double clearance);
  /// True if a path may begin or end in all of these contacts.
  [[nodiscard]] bool may_leave(const std::vector<Touch>& touches) const;
  /// Returns the configuration near `near` that reaches the goal in the same posture, if any.
  [[nodiscard]] std::optional<Configuration> reach(const PoseGoal& goal, const Configuration& near,
                                                   int seeds) const;
  /// True if the straight motion between `end` and `inside` only leaves contact.
  [[nodiscard]] bool is_left_by(const Configuration& end, const Configuration& inside) const;
  /// Returns "'cup' touches obstacle 'table'", or with its distance if it is only near.
  [[nodiscard]] std::string describe(const Touch& touch) const;

  [[nodiscard]] const EndMotions& motions() const { return motions_; }

 private:
  [[nodiscard]] double room_between(const Configuration& from, const Configuration& to,
                                    int states) const;

  const CollisionChecker& checker_;
  EndMotions motions_;
  bool is_start_;
  int states_;
};

}  // namespace mneme::internal
