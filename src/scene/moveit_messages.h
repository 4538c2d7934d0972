// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Poses, robot states and collision objects in MoveIt's messages.
#pragma once

#include "mneme/geometry.h"
#include "mneme/scene.h"

#include "scene/input.h"

#include <cstddef>
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
/// The entries of the list `key`; none if the key is missing or has no value. Throws InputFailure.
[[nodiscard]] std::vector<Input> items_if_any(const Input& input, std::string_view key);
/// The text of the key `frame_id` of the key `header`, or nothing.
[[nodiscard]] std::string read_frame_id(const Input& input);

/// Throws InputFailure.
[[nodiscard]] MoveitState read_moveit_state(const Input& input);
/// `state` with what `difference` says instead, of attached objects by name.
[[nodiscard]] MoveitState overlaid(MoveitState state, const MoveitState& difference);

/// The list `collision_objects` of `world`, and its octomap under that name. Throws InputFailure;
/// a primitive that is no box, sphere or cylinder is refused by name.
[[nodiscard]] std::vector<MoveitObject> read_moveit_objects(const Input& world);

}  // namespace mneme::internal
