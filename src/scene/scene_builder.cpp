// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/scene_builder.h"

#include <fmt/format.h>

#include "base/utf8.h"

namespace mneme::internal {
namespace {

/// Metres; no planner takes what is farther (docs/numerics.md).
constexpr double kFarthest = 1e4;

}  // namespace

Obstacle moved(const Transform& X_AB, Obstacle obstacle) {
  for (Shape& shape : obstacle.shapes) {
    shape = transformed(X_AB, shape);
  }
  return obstacle;
}

Scene moved(const Transform& X_AB, Scene scene) {
  for (Obstacle& obstacle : scene.obstacles) {
    obstacle = moved(X_AB, std::move(obstacle));
  }
  return scene;
}

std::optional<std::string> SceneBuilder::add(const std::string& name, const std::string& body,
                                             const Shape& shape) {
  if (name.empty() && body.empty()) {
    return "expected a name";
  }
  if (!decode_utf8(name) || !decode_utf8(body)) {
    return fmt::format("expected a name that is UTF-8 text without NUL, got \"{}\"",
                       storable_text(name + body));
  }
  const Sphere bound = bounding_sphere(shape);
  // Written so that what is not finite fails too.
  if (!(bound.center.norm() + bound.radius <= kFarthest)) {
    return fmt::format("expected a shape within {} m of the origin", kFarthest);
  }
  const bool is_new_body = !body.empty() && bodies_.count(body) == 0;
  if (is_new_body && names_.count(body) != 0) {
    return fmt::format("expected a body name of its own, got \"{}\", which names an obstacle",
                       body);
  }
  if (body.empty() && bodies_.count(name) != 0) {
    return fmt::format("expected a name of its own, got \"{}\", which names a body", name);
  }
  if (!name.empty() && !names_.insert(name).second) {
    return fmt::format("expected a name of its own, got \"{}\" a second time", name);
  }
  if (body.empty()) {
    obstacles_.push_back({name, {shape}});
  } else if (is_new_body) {
    bodies_[body] = obstacles_.size();
    obstacles_.push_back({body, {shape}});
  } else {
    obstacles_[bodies_[body]].shapes.push_back(shape);
  }
  return std::nullopt;
}

Scene SceneBuilder::take(std::string name) { return {std::move(name), std::move(obstacles_)}; }

}  // namespace mneme::internal
