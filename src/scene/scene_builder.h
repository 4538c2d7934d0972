// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Puts a scene together from single shapes.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "mneme/scene.h"

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
  [[nodiscard]] Scene take(std::string name);

 private:
  std::vector<Obstacle> obstacles_;
  std::set<std::string> names_;                ///< of shapes
  std::map<std::string, std::size_t> bodies_;  ///< positions of composite obstacles
};

}  // namespace mneme::internal
