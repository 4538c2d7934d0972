// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Obstacles and circles as they stand in scene files and in compact problem files.
#pragma once

#include <string_view>

#include "scene/input.h"
#include "scene/scene_builder.h"

namespace mneme::internal {

/// How the two kinds of files spell a pose.
struct ObstacleSpelling {
  std::string_view position;
  std::string_view quaternion;
  bool is_scalar_first = false;  ///< order of the quaternion
};
inline constexpr ObstacleSpelling kSceneSpelling{"position", "quat_xyzw", false};
inline constexpr ObstacleSpelling kCompactSpelling{"p", "q", true};

/// Adds the obstacles of a list of maps. Throws InputFailure.
void read_obstacles(const Input& list, const ObstacleSpelling& spelling, SceneBuilder& scene);

/// Adds circles [x, y, radius] of a list, or of a map from names. Throws InputFailure.
void read_circles(const Input& circles, SceneBuilder& scene);

}  // namespace mneme::internal
