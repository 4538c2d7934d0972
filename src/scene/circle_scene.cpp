// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/scene.h"

namespace mneme {

Scene make_circle_scene(std::string name, const std::vector<std::array<double, 3>>& circles) {
  Scene scene{std::move(name), {}};
  for (const auto& [x, y, radius] : circles) {
    scene.obstacles.push_back(
        {"circle_" + std::to_string(scene.obstacles.size() + 1), {Sphere{{x, y, 0.0}, radius}}});
  }
  return scene;
}

}  // namespace mneme
