// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Workspaces: named rigid obstacles of one or more shapes.
#pragma once

#include "mneme/base.h"
#include "mneme/geometry.h"

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mneme {

/// Metres from the origin; checkers refuse shapes that reach farther (docs/design/numerics.md).
inline constexpr double kFarthestShape = 1e4;

/// Error: unsupported, if a cloud of so many points, those that are not finite included, is more
/// than an obstacle may have: 4 million.
[[nodiscard]] Result<void> check_point_count(std::string_view obstacle, std::size_t points);

/// A named rigid body of one or more shapes, in the frame of the robot's root link. Metres.
struct Obstacle {
  std::string name;
  std::vector<Shape> shapes;
  /// Names of links, and of objects attached to them, that may touch it: they are not checked
  /// against it, with a margin neither.
  std::vector<std::string> may_touch = {};
  /// Names of links that are checked against it by exact geometry (Link::approximation), exactly
  /// and slowly, instead of by their spheres. Not written to files.
  std::vector<std::string> exact_links = {};

  bool operator==(const Obstacle&) const = default;
};

/// The workspace W = {wo_1 .. wo_M} of the paper.
struct Scene {
  std::string name;
  std::vector<Obstacle> obstacles;
  /// Notes on parts left aside while reading its files, such as points that are not finite.
  std::vector<std::string> warnings = {};
  /// Names of two links, one of them with a sphere approximation at least, that are checked against
  /// each other by exact geometry, as those of Obstacle::exact_links. Not written to files.
  std::vector<std::pair<std::string, std::string>> exact_pairs = {};

  /// Nothing if there is no obstacle of this name.
  [[nodiscard]] const Obstacle* find(std::string_view obstacle) const;
  [[nodiscard]] Obstacle* find(std::string_view obstacle);

  // Edits cost what they change: what is kept with points, meshes and octrees stays, but for one
  // wider than the robot's reach that is moved. Each succeeds or leaves the scene as it was. Errors
  // name an obstacle that is not there, is there already, or has a shape without size or parts.

  [[nodiscard]] Result<void> add(Obstacle obstacle);
  [[nodiscard]] Result<void> remove(std::string_view obstacle);
  /// Moves it by X, a motion in the frame of the root link: each pose becomes X times itself.
  [[nodiscard]] Result<void> move(std::string_view obstacle, const Transform& X);
  /// Replaces the points of a cloud from the one at `first` on, given in its frame. The grid that
  /// checkers use is changed in place if no checker and no other scene holds the cloud, otherwise
  /// copied first. `points` must not lie within the cloud's own. Errors, besides: the obstacle is
  /// no cloud, or ends before; coordinates that are not finite.
  [[nodiscard]] Result<void> replace_points(std::string_view obstacle, std::size_t first,
                                            std::span<const CloudPoint> points);

  bool operator==(const Scene&) const = default;
};

/// A scene in a frame that may differ from the robot's root link.
struct FramedScene {
  Scene scene;
  std::string frame;  ///< a link that is fixed to the root; empty for the root itself
  /// That it was read from, but for meshes, clouds and octrees.
  std::vector<std::string> files = {};
};

/// Reads a scene file or MoveIt's planning scene (docs/file_formats.md), whose objects must then
/// share one frame: without a robot it is taken for that of its root link. Errors name file, line
/// and key; names of obstacles must differ.
[[nodiscard]] Result<Scene> load_scene(const std::string& path);
/// The same with the name of that frame.
[[nodiscard]] Result<FramedScene> load_framed_scene(const std::string& path);
/// The same for YAML text; `source` names it in messages.
[[nodiscard]] Result<Scene> parse_scene(std::string_view yaml, const std::string& source);
/// Text that parse_scene reads back to the same scene; only rotations may differ, by rounding. It
/// reads no more than 4 million numbers: larger compound shapes are for files of their own.
[[nodiscard]] std::string to_yaml(const Scene& scene);

/// Text of MoveIt's planning scene that load_framed_scene reads back to the same. Errors: a shape
/// other than spheres, boxes and cylinders; a contact that is allowed; a scene without the name of
/// its frame.
[[nodiscard]] Result<std::string> to_moveit_yaml(const FramedScene& scene);

/// A planar scene: one sphere per circle, centred in the plane z = 0; rows are x, y, radius.
[[nodiscard]] Scene make_circle_scene(std::string name,
                                      const std::vector<std::array<double, 3>>& circles);

}  // namespace mneme
