// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/scene.h"

#include "scene/shape_fields.h"
#include "scene/yaml.h"

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <optional>

namespace mneme {
namespace {

/// The key `allow`, where there are such contacts.
std::string describe_allowed(const Scene& scene) {
  std::vector<std::string> pairs;
  for (const Obstacle& obstacle : scene.obstacles) {
    for (const std::string& link : obstacle.may_touch) {
      pairs.push_back(fmt::format("[{}, {}]", internal::yaml_string(link),
                                  internal::yaml_string(obstacle.name)));
    }
  }
  return pairs.empty() ? "" : fmt::format("allow: [{}]\n", fmt::join(pairs, ", "));
}

}  // namespace

std::string to_yaml(const Scene& scene) {
  std::string text = fmt::format("name: {}\nobstacles:{}\n", internal::yaml_string(scene.name),
                                 scene.obstacles.empty() ? " []" : "");
  for (const Obstacle& obstacle : scene.obstacles) {
    const char* naming_key = obstacle.shapes.size() == 1 ? "name" : "body";
    for (const Shape& shape : obstacle.shapes) {
      text += fmt::format("  - {{{}: {}, {}}}\n", naming_key, internal::yaml_string(obstacle.name),
                          internal::yaml_shape(shape));
    }
  }
  return text + describe_allowed(scene);
}

namespace {

std::string moveit_point(const Vec3& p) { return internal::yaml_numbers({p.data(), 3}); }

std::string moveit_pose(const Transform& X) {
  const Eigen::Vector4d xyzw = Eigen::Quaterniond(X.rotation).coeffs();
  return fmt::format("{{position: {}, orientation: {}}}", moveit_point(X.translation),
                     internal::yaml_numbers({xyzw.data(), 4}));
}

struct Primitive {
  std::string shape;
  std::string pose;
};

/// Nothing for what MoveIt lacks.
struct DescribeForMoveit {
  using Answer = std::optional<Primitive>;
  Answer operator()(const Sphere& s) const {
    return Primitive{
        fmt::format("{{type: sphere, dimensions: [{}]}}", internal::yaml_number(s.radius)),
        moveit_pose({Eigen::Matrix3d::Identity(), s.center})};
  }
  Answer operator()(const Box& s) const {
    return Primitive{
        fmt::format("{{type: box, dimensions: {}}}", moveit_point(2.0 * s.half_extents)),
        moveit_pose(s.pose)};
  }
  Answer operator()(const Cylinder& s) const {
    return Primitive{fmt::format("{{type: cylinder, dimensions: [{}, {}]}}",
                                 internal::yaml_number(s.length), internal::yaml_number(s.radius)),
                     moveit_pose(s.pose)};
  }
  Answer operator()(const Capsule&) const { return std::nullopt; }
  template <class Part>
  Answer operator()(const CompoundShape<Part>&) const {
    return std::nullopt;
  }
};

Result<std::string> describe(const Obstacle& obstacle, const std::string& frame) {
  std::string shapes;
  std::string poses;
  for (const Shape& shape : obstacle.shapes) {
    const auto primitive = std::visit(DescribeForMoveit{}, shape);
    if (!primitive) {
      return fail(ErrorCode::unsupported,
                  fmt::format("obstacle \"{}\" has the type {}; expected spheres, boxes and "
                              "cylinders alone",
                              obstacle.name, shape_name(shape)));
    }
    shapes += fmt::format("        - {}\n", primitive->shape);
    poses += fmt::format("        - {}\n", primitive->pose);
  }
  return fmt::format(
      "    - id: {}\n      header: {{frame_id: {}}}\n      primitives:\n{}      "
      "primitive_poses:\n{}"
      "      operation: add\n",
      internal::yaml_string(obstacle.name), internal::yaml_string(frame), shapes, poses);
}

}  // namespace

Result<std::string> to_moveit_yaml(const FramedScene& framed) {
  if (framed.frame.empty()) {
    return fail(ErrorCode::invalid,
                fmt::format("scene \"{}\": expected the name of its frame, which MoveIt needs",
                            framed.scene.name));
  }
  std::string text = fmt::format("name: {}\nworld:\n  collision_objects:{}\n",
                                 internal::yaml_string(framed.scene.name),
                                 framed.scene.obstacles.empty() ? " []" : "");
  for (const Obstacle& obstacle : framed.scene.obstacles) {
    if (!obstacle.may_touch.empty()) {
      return fail(ErrorCode::unsupported,
                  fmt::format("\"{}\" may touch obstacle \"{}\"; expected a scene without allowed "
                              "contacts: MoveIt has them in a matrix of all links",
                              obstacle.may_touch.front(), obstacle.name));
    }
    const auto described = describe(obstacle, framed.frame);
    if (!described) return described;
    text += *described;
  }
  return text;
}

}  // namespace mneme
