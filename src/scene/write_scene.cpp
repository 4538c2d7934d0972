// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/scene.h"

#include "scene/yaml_text.h"

#include <fmt/format.h>
#include <Eigen/Geometry>

namespace mneme {
namespace {

std::string number(double value) { return internal::yaml_number(value); }

std::string point(const Vec3& p) { return internal::yaml_numbers({p.data(), 3}); }

std::string pose(const Transform& X) {
  std::string text = "position: " + point(X.translation);
  if (X.rotation != Eigen::Matrix3d::Identity()) {
    const Eigen::Vector4d xyzw = Eigen::Quaterniond(X.rotation).coeffs();
    text += ", quat_xyzw: " + internal::yaml_numbers({xyzw.data(), 4});
  }
  return text;
}

struct DescribeShape {
  std::string operator()(const Sphere& s) const {
    return fmt::format("position: {}, radius: {}", point(s.center), number(s.radius));
  }
  std::string operator()(const Box& s) const {
    return fmt::format("{}, size: {}", pose(s.pose), point(2.0 * s.half_extents));
  }
  std::string operator()(const Cylinder& s) const {
    return fmt::format("{}, radius: {}, length: {}", pose(s.pose), number(s.radius),
                       number(s.length));
  }
  std::string operator()(const Capsule& s) const {
    return fmt::format("a: {}, b: {}, radius: {}", point(s.a), point(s.b), number(s.radius));
  }
};

}  // namespace

std::string to_yaml(const Scene& scene) {
  std::string text = fmt::format("name: {}\nobstacles:{}\n", internal::yaml_string(scene.name),
                                 scene.obstacles.empty() ? " []" : "");
  for (const Obstacle& obstacle : scene.obstacles) {
    const char* naming_key = obstacle.shapes.size() == 1 ? "name" : "body";
    for (const Shape& shape : obstacle.shapes) {
      text += fmt::format("  - {{{}: {}, type: {}, {}}}\n", naming_key,
                          internal::yaml_string(obstacle.name), shape_name(shape),
                          std::visit(DescribeShape{}, shape));
    }
  }
  return text;
}

}  // namespace mneme
