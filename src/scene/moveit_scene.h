// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// MoveIt's messages, planning scenes and their frames. All readers throw InputFailure.
#pragma once

#include "mneme/geometry.h"
#include "mneme/scene.h"

#include "input/input.h"

#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

/// The key `position`, and `orientation` if present.
[[nodiscard]] Transform read_moveit_pose(const Input& input);
/// A quaternion with the keys x, y, z, w, or a list of them.
[[nodiscard]] Eigen::Matrix3d read_moveit_rotation(const Input& input);
/// The key `translation`, and `rotation` if present.
[[nodiscard]] Transform read_moveit_transform(const Input& input);

struct MoveitObject {
  Obstacle obstacle;  ///< in `frame`
  std::string frame;
  Input place;
  std::size_t plane_count = 0;  ///< the last `plane_count` shapes represent infinite planes
};

/// An object that a link carries. Without shapes: the world's object of this name.
struct MoveitAttached {
  MoveitObject object;
  std::string link;
  std::vector<std::string> touch_links;
};

struct MoveitState {
  std::map<std::string, double> positions;  ///< by joint
  /// Poses of the robot's root link in `pose_frame`, by virtual joint, and of planar and floating
  /// joints.
  std::map<std::string, Transform> poses;
  std::string pose_frame;
  std::vector<MoveitAttached> attached;
};

inline constexpr std::string_view kConeFault = "a cone is taken for the cylinder around it";
/// A box, sphere or cylinder, also around a cone; errors for other types name the `owner`.
[[nodiscard]] Shape read_moveit_primitive(const Input& primitive, const Transform& pose,
                                          std::string_view owner);
/// Returns `frame_id` of the key `header`; empty without it.
[[nodiscard]] std::string read_frame_id(const Input& input);

[[nodiscard]] MoveitState read_moveit_state(const Input& input);
/// Returns `state` with values and attached objects of `difference` in place of its own.
[[nodiscard]] MoveitState overlaid(MoveitState state, const MoveitState& difference);

/// Reads `collision_objects` of `world`, and its octomap as the object "octomap".
[[nodiscard]] std::vector<MoveitObject> read_moveit_objects(const Input& world);

/// Returns the pose of a link in the frame of the root link, or nothing for an unknown link. May
/// throw InputFailure that names `place`.
using FindLink =
    std::function<std::optional<Transform>(const std::string& name, const Input& place)>;

class MoveitFrames {
 public:
  /// Reads `fixed_frame_transforms` of `scene` and the robot's pose from `state`, which has at most
  /// one pose.
  MoveitFrames(const Input& scene, const MoveitState& state);

  /// The planning frame P, in which the robot's root link R has any pose; empty if not given.
  [[nodiscard]] const std::string& planning_frame() const { return planning_frame_; }
  [[nodiscard]] const std::optional<Transform>& X_PR() const { return X_PR_; }

  /// Returns the pose of `frame` in the frame of the root link; `place` is where it is named.
  /// Empty: the planning frame. Throws InputFailure for an unknown frame.
  [[nodiscard]] Transform pose_in_root(const std::string& frame, const Input& place,
                                       const FindLink& find_link) const;

 private:
  std::string planning_frame_;
  std::map<std::string, Transform> X_PF_;
  std::optional<Transform> X_PR_;
};

/// Returns true for MoveIt's scene text, which RViz saves as .scene: after a first line with the
/// name comes "* " of an object, or a dot.
[[nodiscard]] bool is_scene_text(std::string_view text);
/// Reads scene text with or without poses of objects, in the frame of the robot's root link.
[[nodiscard]] Scene read_scene_text(std::string_view text, const std::string& source,
                                    const std::string& default_name);

/// Returns a thin box for the plane a x + b y + c z + d = 0 in `pose`; nothing without a normal.
[[nodiscard]] std::optional<Box> box_of_plane(const std::array<double, 4>& abcd,
                                              const Transform& pose);
/// Returns the box of a plane, centred at the point of the plane nearest to the origin.
[[nodiscard]] Box centred_plane(Box plane);

/// Returns true if `input` has a key of a planning scene.
[[nodiscard]] bool is_moveit_scene(const Input& input);

struct MoveitScene {
  std::string name;
  std::string robot_name;  ///< Empty if not given.
  std::vector<MoveitObject> objects;
  MoveitState state;
};

/// Reads all except frames and allowed collisions. Padded and scaled links are refused.
[[nodiscard]] MoveitScene read_moveit_scene(const Input& input, const std::string& default_name);

/// Returns the objects in the frame of the robot's root link.
[[nodiscard]] Scene place_objects(const MoveitScene& scene, const MoveitFrames& frames,
                                  const FindLink& find_link);

/// Returns the objects in the frame that they all share; empty name: the robot's root link.
[[nodiscard]] FramedScene place_objects(const MoveitScene& scene, const MoveitFrames& frames);

}  // namespace mneme::internal
