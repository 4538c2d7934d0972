// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// MoveIt's motion plan requests and allowed collisions.
#pragma once

#include "problem/allowed_contacts.h"
#include "scene/input.h"
#include "scene/moveit_messages.h"

#include <map>
#include <string>
#include <vector>

namespace mneme::internal {

/// True if the keys are those of a motion plan request.
[[nodiscard]] bool is_moveit_request(const Input& input);

/// What a joint constraint allows.
struct JointRange {
  double least = 0, most = 0;
};

struct MoveitRequest {
  std::string group;
  MoveitState start;                                     ///< what it says other than the scene
  std::vector<std::map<std::string, JointRange>> goals;  ///< by joint; none of a pose
  std::vector<Input> goal_places;
  std::vector<Input> path_constraints;  ///< of orientation
};

/// Throws InputFailure; goals and paths that are constrained otherwise are refused by name.
[[nodiscard]] MoveitRequest read_moveit_request(const Input& input);

/// Reads `allowed_collision_matrix` of `scene`. Throws InputFailure if it is malformed; returns a
/// warning that names those of its names that `contacts` does not know, if there are any. Two
/// obstacles may touch in any case. Defaults count for pairs without an entry, as in MoveIt: that
/// of either name, both if both have one.
[[nodiscard]] std::vector<std::string> read_moveit_allowed(const Input& scene,
                                                           const std::vector<std::string>& names,
                                                           AllowedContacts& contacts);

}  // namespace mneme::internal
