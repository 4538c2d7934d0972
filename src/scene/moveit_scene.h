// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// MoveIt's planning scenes, and the frames that they speak of.
#pragma once

#include "mneme/geometry.h"
#include "mneme/scene.h"

#include "scene/moveit_messages.h"

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace mneme::internal {

/// Pose of a link in the frame of the root link, or nothing if there is no such link. May throw
/// InputFailure with the place that it is given.
using FindLink =
    std::function<std::optional<Transform>(const std::string& name, const Input& place)>;

class MoveitFrames {
 public:
  /// Reads `fixed_frame_transforms` of `scene`, and takes the robot's pose from `state`. Throws
  /// InputFailure.
  MoveitFrames(const Input& scene, const MoveitState& state);

  /// The frame of the whole scene (P), in which the robot's root link (R) may stand anywhere; empty
  /// if the scene does not say.
  [[nodiscard]] const std::string& planning_frame() const { return planning_frame_; }
  [[nodiscard]] const std::optional<Transform>& X_PR() const { return X_PR_; }

  /// Pose of `frame` in the frame of the root link; `place` is where `frame` is named. An empty
  /// name stands for the planning frame. Throws InputFailure for a frame that nobody knows.
  [[nodiscard]] Transform pose_in_root(const std::string& frame, const Input& place,
                                       const FindLink& find_link) const;

 private:
  std::string planning_frame_;
  std::map<std::string, Transform> X_PF_;
  std::optional<Transform> X_PR_;
};

/// True if the keys are those of a planning scene.
[[nodiscard]] bool is_moveit_scene(const Input& input);

struct MoveitScene {
  std::string name;
  std::string robot_name;  ///< empty if not given
  std::vector<MoveitObject> objects;
  MoveitState state;
  std::vector<std::string> warnings;
};

/// All of `input` but its frames and its allowed collisions. Padded and scaled links are
/// refused. Throws InputFailure.
[[nodiscard]] MoveitScene read_moveit_scene(const Input& input, const std::string& default_name);

/// The objects in the frame of the robot's root link. Throws InputFailure.
[[nodiscard]] Scene place_objects(const MoveitScene& scene, const MoveitFrames& frames,
                                  const FindLink& find_link);

/// The objects without a robot: they must share one frame, which the scene is then given in; its
/// name is empty if that is the robot's root link. Throws InputFailure.
[[nodiscard]] FramedScene place_objects(const MoveitScene& scene, const MoveitFrames& frames);

}  // namespace mneme::internal
