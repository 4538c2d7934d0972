// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// MoveIt's motion plan requests and allowed collisions.
#pragma once

#include "mneme/robot.h"

#include "scene/input.h"
#include "scene/moveit_messages.h"

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace mneme::internal {

/// True if the keys are those of a motion plan request.
[[nodiscard]] bool is_moveit_request(const Input& input);

struct MoveitRequest {
  std::string group;
  MoveitState start;                                 ///< what it says other than the scene
  std::vector<std::map<std::string, double>> goals;  ///< positions by joint; none of a pose
  std::vector<Input> goal_places;
};

/// Throws InputFailure; goals and paths that are constrained otherwise than by joint positions are
/// refused by name.
[[nodiscard]] MoveitRequest read_moveit_request(const Input& input);

struct MoveitAllowed {
  std::vector<std::pair<std::string, std::string>> pairs;  ///< links that may touch
  std::vector<std::string> warnings;
};

/// Reads `allowed_collision_matrix` of `scene`. Throws InputFailure if a link may touch one of
/// `objects`; names that are neither links nor objects are left aside with a warning.
[[nodiscard]] MoveitAllowed read_moveit_allowed(const Input& scene, const Robot& robot,
                                                const std::vector<std::string>& objects);

}  // namespace mneme::internal
