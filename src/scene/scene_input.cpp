// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/scene_input.h"

#include "base/utf8.h"

#include <fmt/format.h>

#include <cmath>

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

Vec3 read_point(const Input& input) {
  const std::vector<double> p = input.finite_numbers(3, "x, y, z in metres");
  return {p[0], p[1], p[2]};
}

Eigen::Matrix3d read_rotation(const Input& input, bool is_scalar_first) {
  const std::vector<double> q = input.finite_numbers(
      4, is_scalar_first ? "a quaternion w, x, y, z" : "a quaternion x, y, z, w");
  return is_scalar_first ? rotation_of(input, {q[1], q[2], q[3], q[0]})
                         : rotation_of(input, {q[0], q[1], q[2], q[3]});
}

Eigen::Matrix3d rotation_of(const Input& input, const std::array<double, 4>& xyzw) {
  constexpr double kLeastNorm = 1e-6;
  const auto [x, y, z, w] = xyzw;
  if (std::hypot(std::hypot(x, y), std::hypot(z, w)) < kLeastNorm) {
    input.fail(ErrorCode::parse, "expected a quaternion that is not zero");
  }
  return rotation_from_quaternion(w, x, y, z);
}

namespace {

/// Reads the shape of one obstacle, and refuses keys that its type does not have.
class ShapeReader {
 public:
  ShapeReader(const Input& input, const ObstacleSpelling& spelling)
      : input_(input), spelling_(spelling) {}

  Shape read() const {
    const Input type = input_.at("type");
    const std::string name = type.is_text() ? type.text() : "";
    if (name == "sphere") return read_sphere();
    if (name == "box") return read_box();
    if (name == "cylinder") return read_cylinder();
    if (name == "capsule") return read_capsule();
    type.fail_expecting("sphere, box, cylinder or capsule");
  }

 private:
  void allow_posed(std::initializer_list<std::string_view> sizes) const {
    std::vector<std::string_view> keys = {"name", "body", "type", spelling_.position,
                                          spelling_.quaternion};
    keys.insert(keys.end(), sizes);
    input_.allow_keys(keys);
  }

  Transform read_pose() const {
    Transform pose;
    pose.translation = read_point(input_.at(spelling_.position));
    if (const auto quaternion = input_.find(spelling_.quaternion)) {
      pose.rotation = read_rotation(*quaternion, spelling_.is_scalar_first);
    }
    return pose;
  }

  double read_size(std::string_view key) const { return input_.at(key).positive_number(); }

  Shape read_sphere() const {
    allow_posed({"radius"});
    return Sphere{read_pose().translation, read_size("radius")};
  }

  Shape read_box() const {
    allow_posed({"size"});
    const Input size = input_.at("size");
    const std::vector<double> extents = size.finite_numbers(3, "full extents in metres");
    for (const Input& extent : size.items()) {
      static_cast<void>(extent.positive_number());
    }
    return Box{read_pose(), 0.5 * Vec3(extents[0], extents[1], extents[2])};
  }

  Shape read_cylinder() const {
    allow_posed({"radius", "length"});
    return Cylinder{read_pose(), read_size("radius"), read_size("length")};
  }

  Shape read_capsule() const {
    if (input_.find("a") || input_.find("b")) {
      input_.allow_keys({"name", "body", "type", "a", "b", "radius"});
      return Capsule{read_point(input_.at("a")), read_point(input_.at("b")), read_size("radius")};
    }
    allow_posed({"radius", "length"});
    const Transform pose = read_pose();
    const Vec3 to_end = 0.5 * read_size("length") * Vec3::UnitZ();
    return Capsule{pose * Vec3(-to_end), pose * to_end, read_size("radius")};
  }

  const Input& input_;
  const ObstacleSpelling& spelling_;
};

std::string read_name(const Input& input, std::string_view key) {
  const auto name = input.find(key);
  if (!name) {
    return {};
  }
  if (name->text().empty()) {
    name->fail_expecting("a name");
  }
  return name->text();
}

void add(const Input& input, const std::string& name, const std::string& body, const Shape& shape,
         SceneBuilder& scene) {
  if (const auto wrong = scene.add(name, body, shape)) {
    input.fail(ErrorCode::parse, *wrong);
  }
}

}  // namespace

void read_obstacles(const Input& list, const ObstacleSpelling& spelling, SceneBuilder& scene) {
  for (const Input& input : list.items()) {
    const Shape shape = ShapeReader(input, spelling).read();
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
    const double radius = circle.items()[2].positive_number();
    add(circle, name, "", Sphere{{row[0], row[1], 0.0}, radius}, scene);
  }
}

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
