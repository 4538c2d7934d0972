// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// MoveIt's motion plan requests.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "scene/moveit_state.h"

namespace mneme::internal {

/// True if the keys are those of a motion plan request.
[[nodiscard]] bool is_moveit_request(const Input& input);

struct MoveitRequest {
  std::string group;
  MoveitState start;                                 ///< what it says other than the scene
  std::vector<std::map<std::string, double>> goals;  ///< positions by joint
  std::vector<Input> goal_places;
};

/// Throws InputFailure; goals and paths that are constrained otherwise than by joint positions are
/// refused by name.
[[nodiscard]] MoveitRequest read_moveit_request(const Input& input);

}  // namespace mneme::internal
