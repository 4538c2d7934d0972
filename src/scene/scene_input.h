// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Shapes and scenes in scene files, problem files and compact files. Readers throw InputFailure.
#pragma once

#include "mneme/geometry.h"
#include "mneme/scene.h"

#include "input/input.h"

#include <nlohmann/json_fwd.hpp>

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

namespace mneme::internal {

/// Keys of an obstacle that are not those of its shape.
inline constexpr std::array<std::string_view, 2> kObstacleNaming{"name", "body"};

/// Spelling of a pose in a kind of files.
struct ObstacleSpelling {
  std::string_view position;
  std::string_view quaternion;
  bool is_scalar_first = false;     ///< Order of the quaternion.
  bool writes_no_rotation = false;  ///< Writes the quaternion even if there is no rotation.
  std::span<const std::string_view> naming = kObstacleNaming;
  bool may_name_files = true;  ///< Points, meshes and octrees may be in files.
};
inline constexpr ObstacleSpelling kSceneSpelling{"position", "quat_xyzw", false, false};
inline constexpr ObstacleSpelling kCompactSpelling{"p", "q", true, true};
/// Requests must not name files.
inline constexpr ObstacleSpelling kRequestSpelling{"p", "q", true, true, kObstacleNaming, false};

/// Fails if the shape of `input` is in a file and `spelling` forbids that.
void refuse_file(const Input& input, const ObstacleSpelling& spelling);

/// Three finite numbers.
[[nodiscard]] Vec3 read_point(const Input& input);
/// A size in metres; 0.1 mm for 0, with a warning.
[[nodiscard]] double read_size(const Input& input);
/// A quaternion. One whose length is not 1 is scaled with a warning; fails beyond a factor of 10.
[[nodiscard]] Eigen::Matrix3d read_rotation(const Input& input, bool is_scalar_first);
/// As read_rotation(), for the numbers at `input`.
[[nodiscard]] Eigen::Matrix3d rotation_of(const Input& input, const std::array<double, 4>& xyzw);

/// Reads the shape of an obstacle with the key `type`. Unknown keys of this type are an error.
[[nodiscard]] Shape read_shape(const Input& input, const ObstacleSpelling& spelling);

/// Returns the keys of a shape, for read_shape().
[[nodiscard]] nlohmann::ordered_json shape_json(const Shape& shape,
                                                const ObstacleSpelling& spelling);
/// Returns the keys of a pose.
[[nodiscard]] nlohmann::ordered_json pose_json(const Transform& pose,
                                               const ObstacleSpelling& spelling);
/// Returns a list of shapes with the key `name`, or `body` for a composite obstacle.
[[nodiscard]] nlohmann::ordered_json obstacles_json(const Scene& scene,
                                                    const ObstacleSpelling& spelling);
/// Returns the pairs [LINK, OBSTACLE] that may touch, from Obstacle::may_touch.
[[nodiscard]] nlohmann::ordered_json allowed_json(const Scene& scene);

/// Returns `obstacle` or `scene`, given in frame B, in frame A.
[[nodiscard]] Obstacle moved(const Transform& X_AB, Obstacle obstacle);
[[nodiscard]] Scene moved(const Transform& X_AB, Scene scene);

/// Obstacles of an input. A camera may see nothing: `empty` names the obstacles that consist of
/// clouds without points, which are no part of the scene.
struct Bodies {
  Scene scene;
  std::vector<std::string> empty;
};

class SceneBuilder {
 public:
  /// Adds `shape` as an obstacle, or to the composite obstacle `body` if that is not empty; only
  /// then may `name` be empty. Returns the fault if a name is missing, taken or not UTF-8.
  [[nodiscard]] std::optional<std::string> add(const std::string& name, const std::string& body,
                                               const Shape& shape);
  [[nodiscard]] Bodies take(std::string name);

 private:
  std::vector<Obstacle> obstacles_;            ///< Without shapes for a cloud without points.
  std::set<std::string> names_;                ///< Names of shapes.
  std::map<std::string, std::size_t> bodies_;  ///< Positions of composite obstacles.
};

/// Adds the obstacles of a list of maps.
void read_obstacles(const Input& list, const ObstacleSpelling& spelling, SceneBuilder& scene);

/// Adds circles [x, y, radius] of a list, or of a map from names.
void read_circles(const Input& circles, SceneBuilder& scene);

/// Returns the two names of a pair.
[[nodiscard]] std::pair<std::string, std::string> read_name_pair(const Input& pair);

/// An entry of the key `allow`.
struct AllowedPair {
  std::string first, second;
  std::optional<double> at_ends;  ///< metres of EndContact; nothing: contact is always allowed
};
/// Reads two names, or a map of the keys `pair` and `at_ends`.
[[nodiscard]] AllowedPair read_allowed_pair(const Input& input);

/// Finds obstacles by name, and allows contacts. Valid until obstacles are added, removed or
/// renamed.
class ObstacleContacts {
 public:
  explicit ObstacleContacts(Scene& scene);
  [[nodiscard]] const Scene& scene() const { return scene_; }
  /// Returns null if there is no obstacle of this name.
  [[nodiscard]] Obstacle* find(const std::string& name) const;
  /// Adds a link to Obstacle::may_touch, unless this object has added it before.
  void allow(Obstacle& obstacle, const std::string& link);
  /// Adds a pair to Scene::end_contacts.
  void allow_at_ends(const AllowedPair& pair) {
    scene_.end_contacts.push_back({pair.first, pair.second, *pair.at_ends});
  }

 private:
  Scene& scene_;
  std::unordered_map<std::string_view, Obstacle*> obstacles_;
  std::set<std::pair<const Obstacle*, std::string>> allowed_;
};

/// Adds pairs of a link and an obstacle to Obstacle::may_touch or Scene::end_contacts.
void read_allowed_contacts(const Input& list, Scene& scene);

/// Reads the keys `circles` and `obstacles`, each of which may be missing.
[[nodiscard]] Bodies read_bodies(const Input& input, const ObstacleSpelling& spelling,
                                 const std::string& name);

/// Reads a scene file. `default_name` is the name of a scene without one.
[[nodiscard]] Scene read_scene(const Input& input, const std::string& default_name);

/// Errors: a shape with a flaw (find_flaw()); more points than check_point_count() allows.
[[nodiscard]] Result<void> check_shapes(const Obstacle& obstacle);

}  // namespace mneme::internal
