// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// MoveIt's planning scenes.
#pragma once

#include <string>
#include <vector>

#include "mneme/scene.h"
#include "scene/moveit_frames.h"
#include "scene/moveit_objects.h"

namespace mneme::internal {

/// True if the keys are those of a planning scene.
[[nodiscard]] bool is_moveit_scene(const Input& input);

struct MoveitScene {
  std::string name;
  std::string robot_name;  ///< empty if not given
  std::vector<MoveitObject> objects;
  MoveitState state;
  std::vector<std::string> warnings;
};

/// All of `input` but its frames and its allowed collisions. Padded and scaled links and octomaps
/// are refused. Throws InputFailure.
[[nodiscard]] MoveitScene read_moveit_scene(const Input& input, const std::string& default_name);

/// The objects in the frame of the robot's root link. Throws InputFailure.
[[nodiscard]] Scene place_objects(const MoveitScene& scene, const MoveitFrames& frames,
                                  const FindLink& find_link);

/// The objects without a robot: they must share one frame, which the scene is then given in; its
/// name is empty if that is the robot's root link. Throws InputFailure.
[[nodiscard]] FramedScene place_objects(const MoveitScene& scene, const MoveitFrames& frames);

}  // namespace mneme::internal
