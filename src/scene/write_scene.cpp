// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/scene.h"

#include "base/fail.h"
#include "scene/scene_input.h"
#include "input/input.h"

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <optional>
#include <vector>

namespace mneme {

using Json = nlohmann::ordered_json;

std::string to_yaml(const Scene& scene) {
  const Json obstacles = internal::obstacles_json(scene, internal::kSceneSpelling);
  const Json allowed = internal::allowed_json(scene);
  return fmt::format(
      "name: {}\n{}{}", internal::yaml_string(scene.name),
      obstacles.empty() ? "obstacles: []\n" : internal::yaml_list("obstacles", obstacles),
      allowed.empty() ? "" : fmt::format("allow: {}\n", internal::yaml_flow(allowed)));
}

namespace {

/// A shape_msgs/SolidPrimitive.
struct MoveitPrimitive {
  const char* type;
  std::vector<double> dimensions;
  Transform pose;

  [[nodiscard]] std::string shape_text() const {
    return internal::yaml_flow({{"type", type}, {"dimensions", dimensions}});
  }
  [[nodiscard]] std::string pose_text() const {
    const Vec3& p = pose.translation;
    const Eigen::Quaterniond q(pose.rotation);
    return internal::yaml_flow(
        {{"position", {p.x(), p.y(), p.z()}}, {"orientation", {q.x(), q.y(), q.z(), q.w()}}});
  }
};

/// Returns nothing for shapes that MoveIt lacks.
struct DescribeForMoveit {
  using Answer = std::optional<MoveitPrimitive>;
  Answer operator()(const Sphere& s) const {
    return MoveitPrimitive{"sphere", {s.radius}, {Eigen::Matrix3d::Identity(), s.center}};
  }
  Answer operator()(const Box& s) const {
    const Vec3 size = 2.0 * s.half_extents;
    return MoveitPrimitive{"box", {size.x(), size.y(), size.z()}, s.pose};
  }
  Answer operator()(const Cylinder& s) const {
    return MoveitPrimitive{"cylinder", {s.length, s.radius}, s.pose};
  }
  Answer operator()(const auto&) const { return std::nullopt; }
};

Result<std::string> describe(const Obstacle& obstacle, const std::string& frame) {
  std::string shapes;
  std::string poses;
  for (const Shape& shape : obstacle.shapes) {
    const auto primitive = std::visit(DescribeForMoveit{}, shape);
    if (!primitive) {
      return fail(ErrorCode::unsupported,
                  "obstacle \"{}\" has the type {}; expected spheres, boxes and "
                  "cylinders alone",
                  obstacle.name, shape_name(shape));
    }
    shapes += fmt::format("        - {}\n", primitive->shape_text());
    poses += fmt::format("        - {}\n", primitive->pose_text());
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
                "scene \"{}\": the frame has no name, which MoveIt needs; name one (--frame)",
                framed.scene.name);
  }
  if (!framed.scene.end_contacts.empty()) {
    const EndContact& contact = framed.scene.end_contacts.front();
    return fail(ErrorCode::unsupported,
                "\"{}\" may touch \"{}\" at the ends of a path; expected a scene without allowed "
                "contacts: MoveIt has none of these",
                contact.first, contact.second);
  }
  std::string text = fmt::format("name: {}\nworld:\n  collision_objects:{}\n",
                                 internal::yaml_string(framed.scene.name),
                                 framed.scene.obstacles.empty() ? " []" : "");
  for (const Obstacle& obstacle : framed.scene.obstacles) {
    if (!obstacle.may_touch.empty()) {
      return fail(ErrorCode::unsupported,
                  "\"{}\" may touch obstacle \"{}\"; expected a scene without allowed "
                  "contacts: MoveIt has them in a matrix of all links",
                  obstacle.may_touch.front(), obstacle.name);
    }
    const std::string described = MNEME_TRY(describe(obstacle, framed.frame));
    text += described;
  }
  return text;
}

}  // namespace mneme
