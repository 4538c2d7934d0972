// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Scenes as they stand in scene files, inside problem files and in compact files.
#pragma once

#include "mneme/scene.h"

#include "scene/input.h"
#include "scene/shape_fields.h"

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

namespace mneme::internal {

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

}  // namespace mneme::internal
