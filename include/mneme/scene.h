// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Workspaces: named rigid obstacles of one or more shapes.
#pragma once

#include "mneme/base.h"
#include "mneme/geometry.h"

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

namespace mneme {

/// Largest distance of a shape from the origin, metres. Checkers refuse shapes farther out
/// (docs/design/numerics.md).
inline constexpr double kFarthestShape = 1e4;

/// Checks the number of points of an obstacle, including those that are not finite. Error:
/// unsupported for more than 4 million.
[[nodiscard]] Result<void> check_point_count(std::string_view obstacle, std::size_t points);

/// A named rigid body of one or more shapes, in the frame of the robot's root link, in metres.
struct Obstacle {
  std::string name;
  std::vector<Shape> shapes;
  /// Names of links and attached objects that may touch the obstacle: such pairs are not checked.
  std::vector<std::string> may_touch = {};
  /// Names of links that are checked against the obstacle by exact geometry (Link::approximation)
  /// instead of spheres, which is precise but slow. Not written to files.
  std::vector<std::string> exact_links = {};

  bool operator==(const Obstacle&) const = default;
};

/// Two bodies that may touch at the start and at the goal of a path: links, attached objects, or
/// one of these and an obstacle. In between the pair is checked as any other.
struct EndContact {
  std::string first, second;  ///< names
  /// Largest distance, metres, that a body of the pair may move while they touch.
  double stretch = 0.005;

  bool operator==(const EndContact&) const = default;
};

namespace internal {

/// Cache of names for Scene::add(). A copy is empty, and all caches compare equal.
class ObstacleNames {
 public:
  ObstacleNames() = default;
  ObstacleNames(const ObstacleNames&) {}
  ObstacleNames& operator=(const ObstacleNames&) {  // NOLINT(bugprone-unhandled-self-assignment)
    return *this = ObstacleNames();
  }
  ObstacleNames(ObstacleNames&&) noexcept = default;
  ObstacleNames& operator=(ObstacleNames&&) noexcept = default;
  ~ObstacleNames() = default;
  bool operator==(const ObstacleNames&) const { return true; }

  /// Returns the position of the obstacle `name`. Reads `obstacles` anew if other code changed the
  /// list.
  [[nodiscard]] std::optional<std::size_t> find(const std::vector<Obstacle>& obstacles,
                                                const std::string& name);
  /// Adds the last obstacle of the list.
  void add_last(const std::vector<Obstacle>& obstacles);

 private:
  const Obstacle* data_ = nullptr;
  std::size_t size_ = 0;
  std::unordered_map<std::string, std::size_t> positions_;
};

}  // namespace internal

/// The workspace W = {wo_1 .. wo_M} of the paper.
struct Scene {
  std::string name = {};
  std::vector<Obstacle> obstacles = {};
  /// Warnings from reading the scene's files, such as points that are not finite.
  std::vector<std::string> warnings = {};
  /// Pairs of links that are checked against each other by exact geometry; at least one of the two
  /// has a sphere approximation. Not written to files.
  std::vector<std::pair<std::string, std::string>> exact_pairs = {};
  /// Pairs that may touch at the ends of a path, beyond those of EndTolerances.
  std::vector<EndContact> end_contacts = {};
  internal::ObstacleNames names = {};  ///< For add() only.

  /// Returns the obstacle of this name, or null if there is none.
  [[nodiscard]] const Obstacle* find(std::string_view obstacle) const;
  [[nodiscard]] Obstacle* find(std::string_view obstacle);

  // Edits either succeed or leave the scene unchanged. Search structures of clouds, meshes and
  // octrees are kept; only those of a moved shape that is wider than the robot's reach are built
  // again. Errors: an unknown obstacle, a name that is taken, a shape without size or parts.

  /// Adds an obstacle. Cost: constant on average. May miss names that other code changed in
  /// `obstacles`.
  [[nodiscard]] Result<void> add(Obstacle obstacle);
  /// Adds a shape to the obstacle of this name, or an obstacle with the shape if there is none.
  /// Cost and errors: those of add().
  [[nodiscard]] Result<void> add_shape(const std::string& obstacle, Shape shape);
  /// Removes an obstacle and what `end_contacts` says of it.
  [[nodiscard]] Result<void> remove(std::string_view obstacle);
  /// Moves an obstacle by X in the frame of the root link: each pose becomes X * pose. Rounding
  /// does not accumulate in rotations. Error: X is not a rigid motion.
  [[nodiscard]] Result<void> move(std::string_view obstacle, const Transform& X);
  /// Replaces the points of a cloud from index `first` on, in the cloud's frame. `points` must not
  /// alias the cloud's own. The checkers' grid is updated in place, or copied first if another
  /// scene or checker shares the cloud. Errors: the obstacle is not one cloud, the range is beyond
  /// the cloud's points, coordinates that are not finite.
  [[nodiscard]] Result<void> replace_points(std::string_view obstacle, std::size_t first,
                                            std::span<const CloudPoint> points);

  /// Builds search structures for the clouds, meshes and octrees of an obstacle, so that the first
  /// plan takes no longer than later ones. For robots that reach up to 2 m. Cost: about 2 s for a
  /// million triangles.
  void prepare(std::string_view obstacle) const;

  bool operator==(const Scene&) const = default;
};

/// A scene whose frame may differ from the robot's root link.
struct FramedScene {
  Scene scene;
  std::string frame = {};  ///< A link that is fixed to the root; empty for the root itself.
  /// Files that the scene was read from, except meshes, clouds and octrees.
  std::vector<std::string> files = {};
};

/// Reads a scene file or MoveIt's planning scene (docs/file_formats.md). The objects of a planning
/// scene must share one frame, which counts as that of the root link: load_framed_scene() says
/// which it is. Errors name file, line and key: malformed text, repeated names.
[[nodiscard]] Result<Scene> load_scene(const std::string& path);
/// As load_scene(), with the name of the scene's frame.
[[nodiscard]] Result<FramedScene> load_framed_scene(const std::string& path);
/// As load_scene() for YAML text; `source` names the text in messages.
[[nodiscard]] Result<Scene> parse_scene(std::string_view yaml, const std::string& source);
/// Returns YAML that parse_scene() reads back to the same scene; rotations may differ by rounding.
/// parse_scene() reads at most 4 million values: keep larger clouds and meshes in separate files.
[[nodiscard]] std::string to_yaml(const Scene& scene);

/// Returns MoveIt's planning scene as YAML, which load_framed_scene() reads back to the same scene.
/// Errors: a shape other than spheres, boxes and cylinders; an obstacle with `may_touch`;
/// `end_contacts`; an empty `frame`.
[[nodiscard]] Result<std::string> to_moveit_yaml(const FramedScene& framed);

/// Returns a planar scene with a sphere in the plane z = 0 per circle; rows are x, y, radius.
[[nodiscard]] Scene make_circle_scene(std::string name,
                                      const std::vector<std::array<double, 3>>& circles);

}  // namespace mneme
