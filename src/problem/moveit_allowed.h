// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The allowed collision matrix of MoveIt's planning scenes.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "mneme/robot.h"
#include "scene/input.h"

namespace mneme::internal {

struct MoveitAllowed {
  std::vector<std::pair<std::string, std::string>> pairs;  ///< links that may touch
  std::vector<std::string> warnings;
};

/// Reads `allowed_collision_matrix` of `scene`. Throws InputFailure if a link may touch one of
/// `objects`; names that are neither links nor objects are left aside with a warning.
[[nodiscard]] MoveitAllowed read_moveit_allowed(const Input& scene, const Robot& robot,
                                                const std::vector<std::string>& objects);

}  // namespace mneme::internal
