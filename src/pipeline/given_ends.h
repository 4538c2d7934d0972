// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Starts and goals that slightly violate limits, cones or distances.
#pragma once

#include "pipeline/query.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace mneme::internal {

/// Ends of a query as they were given, where planning uses configurations nearby instead.
struct GivenEnds {
  struct Goal {
    Configuration inside, given;
  };
  std::optional<Configuration> start;
  std::vector<Goal> goals;
  std::vector<std::string> notes;  ///< for people: a sentence about each exception
  /// Why a start within the tolerances has no replacement; empty if there is no such start.
  std::string start_failure = {};

  [[nodiscard]] bool empty() const { return !start && goals.empty(); }
  /// Names of the start and of each goal of `ends` in notes, which tell replaced ones from given.
  [[nodiscard]] std::vector<std::string> names(const PlanQuery& ends) const;
  /// Returns `path` with the given start and goal as its first and last waypoint.
  [[nodiscard]] Path completed(const Robot& robot, Path path) const;
};

/// True for ends that differ at most by rounding to single precision.
[[nodiscard]] inline bool is_same_end(const Robot& robot, const Configuration& a,
                                      const Configuration& b) {
  return robot.distance(a, b) < 1e-6;
}

/// Replaces start and goals of `ends` that violate a limit, cone or distance, within the tolerances
/// of the settings, by valid configurations nearby. The straight motion between an end and its
/// replacement only reduces the violation and adds no other. Other ends stay. `first` is the number
/// of the first goal in the query, from 0. Cost: milliseconds per replaced end. Throws Interrupted.
[[nodiscard]] GivenEnds move_ends_inside(const Query& query, const CollisionChecker& checker,
                                         PlanQuery& ends, std::size_t first = 0);

}  // namespace mneme::internal
