// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/scene_input.h"

#include "scene/obstacle_input.h"

namespace mneme::internal {

Scene read_scene(const Input& input, const std::string& default_name) {
  input.allow_keys({"name", "circles", "obstacles"});
  SceneBuilder scene;
  if (const auto circles = input.find("circles")) {
    read_circles(*circles, scene);
  }
  if (const auto obstacles = input.find("obstacles")) {
    read_obstacles(*obstacles, kSceneSpelling, scene);
  }
  const auto name = input.find("name");
  return scene.take(name ? name->text() : default_name);
}

}  // namespace mneme::internal
