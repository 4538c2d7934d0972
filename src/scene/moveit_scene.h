// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// MoveIt's messages, its planning scenes, and the frames that they speak of.
#pragma once

#include "mneme/geometry.h"
#include "mneme/scene.h"

#include "scene/input.h"

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

/// A list of three numbers, or the keys x, y and z. Throws InputFailure.
[[nodiscard]] Vec3 read_moveit_point(const Input& input);
/// The keys `position` and `orientation`, which may be missing. Throws InputFailure.
[[nodiscard]] Transform read_moveit_pose(const Input& input);
/// A quaternion with the keys x, y, z, w, or a list of them. Throws InputFailure.
[[nodiscard]] Eigen::Matrix3d read_moveit_rotation(const Input& input);
/// The keys `translation` and `rotation`. Throws InputFailure.
[[nodiscard]] Transform read_moveit_transform(const Input& input);

struct MoveitObject {
  Obstacle obstacle;  ///< in `frame`
  std::string frame;
  Input place;
  std::size_t plane_count = 0;  ///< so many of its shapes, the last ones, stand for endless planes
};

/// An object that a link carries. Without shapes it is the world's object of this name.
struct MoveitAttached {
  MoveitObject object;
  std::string link;
  std::vector<std::string> touch_links;
};

struct MoveitState {
  std::map<std::string, double> positions;  ///< by joint
  /// Pose of the robot's root link in `base_frame`, as a virtual joint has it.
  std::optional<Transform> base;
  std::string base_frame;
  std::vector<MoveitAttached> attached;
};

/// A box, sphere or cylinder. Throws InputFailure, with the name of its `owner` for others.
[[nodiscard]] Shape read_moveit_primitive(const Input& primitive, const Transform& pose,
                                          std::string_view owner);
/// The text of the key `frame_id` of the key `header`, or nothing.
[[nodiscard]] std::string read_frame_id(const Input& input);

/// Throws InputFailure.
[[nodiscard]] MoveitState read_moveit_state(const Input& input);
/// `state` with what `difference` says instead, of attached objects by name.
[[nodiscard]] MoveitState overlaid(MoveitState state, const MoveitState& difference);

/// The list `collision_objects` of `world`, and its octomap under that name. Throws InputFailure;
/// a primitive that is no box, sphere or cylinder is refused by name.
[[nodiscard]] std::vector<MoveitObject> read_moveit_objects(const Input& world);

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
