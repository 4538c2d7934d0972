// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "service/scene_store.h"

#include "base/fail.h"

#include <utility>

namespace mneme::internal {

SceneStore::Kept SceneStore::find(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const auto found = scenes_.find(id);
  return found == scenes_.end() ? nullptr : found->second;
}

Result<SceneStore::Kept> SceneStore::put(const std::string& id, Scene scene) {
  auto kept = std::make_shared<const Scene>(std::move(scene));
  const std::lock_guard editing(editing_);
  const std::lock_guard lock(mutex_);
  if (scenes_.size() >= most_ && !scenes_.contains(id)) {
    return fail(ErrorCode::invalid,
                "there are {} scenes already, the limit of this service: delete one first",
                scenes_.size());
  }
  scenes_[id] = kept;
  return kept;
}

Result<SceneStore::Kept> SceneStore::change(
    const std::string& id, const std::function<Result<Scene>(const Scene&)>& edit) {
  const std::lock_guard editing(editing_);
  const Kept before = find(id);
  if (before == nullptr) return before;
  Scene edited = MNEME_TRY(edit(*before));
  auto kept = std::make_shared<const Scene>(std::move(edited));
  const std::lock_guard lock(mutex_);
  const auto found = scenes_.find(id);
  if (found == scenes_.end()) return Kept();
  found->second = kept;
  return kept;
}

bool SceneStore::remove(const std::string& id) {
  const std::lock_guard lock(mutex_);
  return scenes_.erase(id) > 0;
}

std::size_t SceneStore::count() const {
  const std::lock_guard lock(mutex_);
  return scenes_.size();
}

}  // namespace mneme::internal
