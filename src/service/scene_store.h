// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The scenes that clients have uploaded.
#pragma once

#include "mneme/scene.h"

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>

namespace mneme::internal {

/// Scenes by their ids, in the frame of the robot's root link. Whoever has got one keeps it as it
/// was. All of it is safe from any thread.
class SceneStore {
 public:
  using Kept = std::shared_ptr<const Scene>;
  explicit SceneStore(int most) : most_(static_cast<std::size_t>(most)) {}

  /// Null if there is none.
  [[nodiscard]] Kept find(const std::string& id) const;
  /// Puts a scene in the place of the one there was. Error: there are too many.
  [[nodiscard]] Result<Kept> put(const std::string& id, Scene scene);
  /// Puts what `edit` makes of the scene that is there, unless that is an error; nobody else puts
  /// one in between. Null if there is none.
  [[nodiscard]] Result<Kept> change(const std::string& id,
                                    const std::function<Result<Scene>(const Scene&)>& edit);
  /// False if there was none.
  bool remove(const std::string& id);
  [[nodiscard]] std::size_t count() const;

 private:
  std::mutex editing_;  ///< taken before mutex_
  mutable std::mutex mutex_;
  std::map<std::string, Kept> scenes_;
  std::size_t most_;
};

}  // namespace mneme::internal
