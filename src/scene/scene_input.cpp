// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/scene_input.h"

#include "base/text.h"
#include "base/threads.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace mneme::internal {
Obstacle moved(const Transform& X_AB, Obstacle obstacle) {
  for (Shape& shape : obstacle.shapes) shape = transformed(X_AB, shape);
  return obstacle;
}

Scene moved(const Transform& X_AB, Scene scene) {
  for (Obstacle& obstacle : scene.obstacles) obstacle = moved(X_AB, std::move(obstacle));
  return scene;
}

namespace {

/// The shape; nothing for a cloud without points or an octree without cubes.
std::vector<Shape> occupied(const Shape& shape) {
  const auto* cloud = std::get_if<PointCloud>(&shape);
  const auto* octree = std::get_if<Octree>(&shape);
  const bool is_empty = (cloud != nullptr && cloud->parts->list().empty()) ||
                        (octree != nullptr && octree->parts->list().empty());
  return is_empty ? std::vector<Shape>() : std::vector<Shape>{shape};
}

/// NaN is not.
bool is_within_reach(const Shape& shape) {
  const Sphere bound = bounding_sphere(shape);
  return bound.center.norm() + bound.radius <= kFarthestShape;
}

}  // namespace

std::optional<std::string> SceneBuilder::add(const std::string& name, const std::string& body,
                                             const Shape& shape) {
  poll_interrupt();
  if (name.empty() && body.empty()) return "expected a name";
  if (!decode_utf8(name) || !decode_utf8(body)) {
    return fmt::format("expected a name that is UTF-8 text without NUL, got \"{}\"", name + body);
  }
  std::vector<Shape> shapes = occupied(shape);
  if (!std::ranges::all_of(shapes, is_within_reach)) {
    return fmt::format("expected a shape within {} m of the origin", kFarthestShape);
  }
  const bool is_new_body = !body.empty() && !bodies_.contains(body);
  if (is_new_body && names_.contains(body)) {
    return fmt::format("expected a unique body name, got \"{}\", which names an obstacle", body);
  }
  if (body.empty() && bodies_.contains(name)) {
    return fmt::format("expected a unique name, got \"{}\", which names a body", name);
  }
  if (!name.empty() && !names_.insert(name).second) {
    return fmt::format("expected a unique name, got \"{}\" a second time", name);
  }
  if (body.empty()) {
    obstacles_.push_back({name, std::move(shapes)});
  } else if (is_new_body) {
    bodies_[body] = obstacles_.size();
    obstacles_.push_back({body, std::move(shapes)});
  } else {
    std::ranges::move(shapes, std::back_inserter(obstacles_[bodies_[body]].shapes));
  }
  return std::nullopt;
}

Bodies SceneBuilder::take(std::string name) {
  Bodies bodies{{std::move(name), {}}, {}};
  for (Obstacle& obstacle : obstacles_) {
    if (obstacle.shapes.empty()) {
      bodies.empty.push_back(std::move(obstacle.name));
    } else {
      bodies.scene.obstacles.push_back(std::move(obstacle));
    }
  }
  return bodies;
}

namespace {

std::string read_name(const Input& input, std::string_view key) {
  const auto name = input.find(key);
  if (!name) {
    return {};
  }
  if (name->text().empty()) name->fail_expecting("a name");
  return name->text();
}

void add(const Input& input, const std::string& name, const std::string& body, const Shape& shape,
         SceneBuilder& scene) {
  if (const auto wrong = scene.add(name, body, shape)) input.fail(ErrorCode::parse, *wrong);
}

}  // namespace

void read_obstacles(const Input& list, const ObstacleSpelling& spelling, SceneBuilder& scene) {
  for (const Input& input : list.items()) {
    const Shape shape = read_shape(input, spelling);
    add(input, read_name(input, "name"), read_name(input, "body"), shape, scene);
  }
}

void read_circles(const Input& circles, SceneBuilder& scene) {
  std::vector<std::pair<std::string, Input>> named;
  if (circles.is_map()) {
    named = circles.entries();
  } else {
    for (const Input& circle : circles.items()) {
      named.emplace_back(fmt::format("circle_{}", named.size() + 1), circle);
    }
  }
  for (const auto& [name, circle] : named) {
    const std::vector<double> row = circle.finite_numbers(3, "x, y, radius in metres");
    const double radius = row[2] > 0 ? row[2] : read_size(circle.items()[2]);
    add(circle, name, "", Sphere{{row[0], row[1], 0.0}, radius}, scene);
  }
}

/// Metres: a longer stretch of contact is not an end of a path.
constexpr double kLongestEndContact = 1;

std::pair<std::string, std::string> read_name_pair(const Input& pair) {
  const std::vector<Input> names = pair.is_list() ? pair.items() : std::vector<Input>();
  if (names.size() != 2) {
    pair.fail_expecting(
        "two names that may touch, as in [base_link, table] or {pair: [cup, table], at_ends: "
        "0.01}");
  }
  return {names[0].text(), names[1].text()};
}

AllowedPair read_allowed_pair(const Input& input) {
  const auto [first, second] = read_name_pair(input.is_map() ? input.at("pair") : input);
  AllowedPair allowed{first, second, std::nullopt};
  if (!input.is_map()) return allowed;
  input.allow_keys({"pair", "at_ends"});
  const Input at_ends = input.at("at_ends");
  allowed.at_ends = at_ends.positive_number();
  if (*allowed.at_ends > kLongestEndContact) {
    at_ends.fail_expecting(fmt::format("metres, at most {}", kLongestEndContact));
  }
  return allowed;
}

ObstacleContacts::ObstacleContacts(Scene& scene) : scene_(scene) {
  for (Obstacle& obstacle : scene.obstacles) obstacles_.emplace(obstacle.name, &obstacle);
}

Obstacle* ObstacleContacts::find(const std::string& name) const {
  const auto found = obstacles_.find(name);
  return found == obstacles_.end() ? nullptr : found->second;
}

void ObstacleContacts::allow(Obstacle& obstacle, const std::string& link) {
  if (allowed_.emplace(&obstacle, link).second) obstacle.may_touch.push_back(link);
}

void read_allowed_contacts(const Input& list, Scene& scene) {
  ObstacleContacts contacts(scene);
  for (const Input& pair : list.items()) {
    const AllowedPair allowed = read_allowed_pair(pair);
    if (allowed.at_ends) {
      // Either name may be of a link or of an attached object, which are not known here.
      contacts.allow_at_ends(allowed);
    } else if (Obstacle* obstacle = contacts.find(allowed.second)) {
      contacts.allow(*obstacle, allowed.first);
    } else {
      pair.fail(ErrorCode::invalid,
                "expected a link and an obstacle; the scene has no obstacle \"{}\"",
                allowed.second);
    }
  }
}

Bodies read_bodies(const Input& input, const ObstacleSpelling& spelling, const std::string& name) {
  InputFindings findings;
  const Input bodies = input.collecting(findings);
  SceneBuilder scene;
  if (const auto circles = bodies.find("circles")) read_circles(*circles, scene);
  if (const auto obstacles = bodies.find("obstacles")) read_obstacles(*obstacles, spelling, scene);
  Bodies result = scene.take(name);
  findings.append_to(result.scene.warnings);
  return result;
}

Scene read_scene(const Input& input, const std::string& default_name) {
  input.allow_keys({"name", "circles", "obstacles", "allow"});
  Scene result = read_bodies(input, kSceneSpelling, input.text_or("name", default_name)).scene;
  if (const auto allowed = input.find("allow")) read_allowed_contacts(*allowed, result);
  return result;
}

}  // namespace mneme::internal
