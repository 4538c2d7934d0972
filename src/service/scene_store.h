// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Uploaded scenes.
#pragma once

#include "mneme/scene.h"

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>

namespace mneme::internal {

/// Scenes by id, in the frame of the robot's root link. A scene that was handed out does not
/// change. Thread-safe.
class SceneStore {
 public:
  using Kept = std::shared_ptr<const Scene>;
  explicit SceneStore(int most) : most_(static_cast<std::size_t>(most)) {}

  /// Returns the scene `id`; null if there is none.
  [[nodiscard]] Kept find(const std::string& id) const;
  /// Adds or replaces a scene. Error: the store is full.
  [[nodiscard]] Result<Kept> put(const std::string& id, Scene scene);
  /// Replaces a scene by the result of `edit`, as one atomic step. Returns null if there is none.
  /// Errors: as `edit`.
  [[nodiscard]] Result<Kept> change(const std::string& id,
                                    const std::function<Result<Scene>(const Scene&)>& edit);
  /// Removes the scene `id`. Returns false if there was none.
  bool remove(const std::string& id);
  [[nodiscard]] std::size_t count() const;

 private:
  std::mutex editing_;  ///< taken before mutex_
  mutable std::mutex mutex_;
  std::map<std::string, Kept> scenes_;
  std::size_t most_;
};

}  // namespace mneme::internal
