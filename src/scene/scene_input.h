// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Shapes and scenes as they stand in scene files, inside problem files and in compact files.
#pragma once

#include "mneme/geometry.h"
#include "mneme/scene.h"

#include "scene/input.h"

#include <nlohmann/json_fwd.hpp>

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mneme::internal {

/// Keys of an obstacle besides those of its shape.
inline constexpr std::array<std::string_view, 2> kObstacleNaming{"name", "body"};

/// How the two kinds of files spell a pose.
struct ObstacleSpelling {
  std::string_view position;
  std::string_view quaternion;
  bool is_scalar_first = false;     ///< order of the quaternion
  bool writes_no_rotation = false;  ///< as a quaternion, instead of leaving it out
  std::span<const std::string_view> naming = kObstacleNaming;  ///< keys besides those of the shape
  bool may_name_files = true;                                  ///< of points, meshes and octrees
};
inline constexpr ObstacleSpelling kSceneSpelling{"position", "quat_xyzw", false, false};
inline constexpr ObstacleSpelling kCompactSpelling{"p", "q", true, true};
/// For requests, which may not name files.
inline constexpr ObstacleSpelling kRequestSpelling{"p", "q", true, true, kObstacleNaming, false};

/// Throws InputFailure if the shape of `input` is in a file and may not be.
void refuse_file(const Input& input, const ObstacleSpelling& spelling);

/// Three finite numbers. Throws InputFailure.
[[nodiscard]] Vec3 read_point(const Input& input);
/// A quaternion that need not have unit length. Throws InputFailure.
[[nodiscard]] Eigen::Matrix3d read_rotation(const Input& input, bool is_scalar_first);
/// The rotation of x, y, z, w, which `input` has; it fails if they are all zero.
[[nodiscard]] Eigen::Matrix3d rotation_of(const Input& input, const std::array<double, 4>& xyzw);

/// The shape of an obstacle that has the key `type` and may have those of `naming`. Throws
/// InputFailure, also for keys that its type does not have.
[[nodiscard]] Shape read_shape(const Input& input, const ObstacleSpelling& spelling,
                               std::vector<std::string>& warnings);

/// The keys of a shape, which read_shape reads back to the same.
[[nodiscard]] nlohmann::ordered_json shape_json(const Shape& shape,
                                                const ObstacleSpelling& spelling);
/// The keys of a pose.
[[nodiscard]] nlohmann::ordered_json pose_json(const Transform& pose,
                                               const ObstacleSpelling& spelling);
/// A list of obstacles, whose shapes are maps with the key `name`, or `body` for one of several.
[[nodiscard]] nlohmann::ordered_json obstacles_json(const Scene& scene,
                                                    const ObstacleSpelling& spelling);
/// Pairs of a link and an obstacle that may touch.
[[nodiscard]] nlohmann::ordered_json allowed_json(const Scene& scene);

/// `obstacle` or `scene`, given in frame B, expressed in frame A.
[[nodiscard]] Obstacle moved(const Transform& X_AB, Obstacle obstacle);
[[nodiscard]] Scene moved(const Transform& X_AB, Scene scene);

class SceneBuilder {
 public:
  /// Adds `shape` as an obstacle of its own, or to the composite obstacle `body` if that is not
  /// empty; only then may `name` be empty. Says what is wrong if a name is missing, taken or
  /// no UTF-8.
  [[nodiscard]] std::optional<std::string> add(const std::string& name, const std::string& body,
                                               const Shape& shape);
  /// To be added to: they become the scene's.
  [[nodiscard]] std::vector<std::string>& warnings() { return warnings_; }
  [[nodiscard]] Scene take(std::string name);

 private:
  std::vector<Obstacle> obstacles_;
  std::vector<std::string> warnings_;
  std::set<std::string> names_;                ///< of shapes
  std::map<std::string, std::size_t> bodies_;  ///< positions of composite obstacles
};

/// Adds the obstacles of a list of maps. Throws InputFailure.
void read_obstacles(const Input& list, const ObstacleSpelling& spelling, SceneBuilder& scene);

/// Adds circles [x, y, radius] of a list, or of a map from names. Throws InputFailure.
void read_circles(const Input& circles, SceneBuilder& scene);

/// Adds pairs [LINK, OBSTACLE] of a list to what may touch the obstacles of `scene`. Throws
/// InputFailure.
void read_allowed_contacts(const Input& list, Scene& scene);

/// The two names of a pair. Throws InputFailure.
[[nodiscard]] std::pair<std::string, std::string> read_name_pair(const Input& pair);

/// Throws InputFailure. `default_name` is the name of a scene that gives none.
[[nodiscard]] Scene read_scene(const Input& input, const std::string& default_name);

/// Errors: a shape with a flaw (find_flaw()); one with more points than check_point_count() allows.
[[nodiscard]] Result<void> check_shapes(const Obstacle& obstacle);

}  // namespace mneme::internal
