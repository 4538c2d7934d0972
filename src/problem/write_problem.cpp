// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/problem.h"

#include "base/as_index.h"
#include "scene/shape_fields.h"
#include "scene/yaml.h"

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <filesystem>
#include <numbers>
#include <sstream>
#include <system_error>

namespace mneme {
namespace {

/// Those that are not planned for and stand elsewhere than at 0.
std::vector<Joint> fixed_joints(const Robot& robot) {
  std::vector<Joint> fixed;
  for (int i = 0; i < static_cast<int>(robot.joints().size()); ++i) {
    const Joint& joint = robot.joints()[internal::as_index(i)];
    const bool is_planned = std::ranges::count(robot.group(), i) > 0;
    if (!is_planned && !joint.mimic && joint.fixed_value != 0.0) fixed.push_back(joint);
  }
  return fixed;
}

/// The keys `joints` and `fixed_joints`. The robot's SRDF may name other joints, or several groups.
std::string describe_group(const Robot& robot) {
  std::vector<std::string> planned, fixed;
  for (int i = 0; i < robot.joint_count(); ++i) {
    planned.push_back(internal::yaml_string(robot.group_joint(i).name));
  }
  for (const Joint& joint : fixed_joints(robot)) {
    fixed.push_back(fmt::format("{}: {}", internal::yaml_string(joint.name),
                                internal::yaml_number(joint.fixed_value)));
  }
  const std::string joints = fmt::format("joints: [{}]\n", fmt::join(planned, ", "));
  if (fixed.empty()) return joints;
  return joints + fmt::format("fixed_joints: {{{}}}\n", fmt::join(fixed, ", "));
}

std::string describe_angle(double angle) {
  return angle >= std::numbers::pi ? "free" : internal::yaml_number(angle);
}

/// A map on one line.
std::string describe_pose(const PoseGoal& goal) {
  const auto vector = [](const Vec3& v) {
    return internal::yaml_numbers(std::array{v.x(), v.y(), v.z()});
  };
  const Eigen::Quaterniond q(goal.pose.rotation);
  return fmt::format(
      "{{link: {}, position: {}, quat_xyzw: {}, position_tolerance: {}, axis: {}, "
      "cone: {}, turn: {}}}",
      internal::yaml_string(goal.link), vector(goal.pose.translation),
      internal::yaml_numbers(std::array{q.x(), q.y(), q.z(), q.w()}),
      vector(goal.position_tolerance), "xyz"[static_cast<int>(goal.axis)],
      describe_angle(goal.cone), describe_angle(goal.turn));
}

/// Its path holds wherever the text is kept.
std::string describe_mesh(const MeshFile& mesh) {
  std::error_code ignored;
  const std::string path = std::filesystem::absolute(mesh.path, ignored).string();
  std::string text = fmt::format("type: mesh, file: {}, scale: {}, position: {}",
                                 internal::yaml_string(path.empty() ? mesh.path : path),
                                 internal::yaml_numbers({mesh.scale.data(), 3}),
                                 internal::yaml_numbers({mesh.pose.translation.data(), 3}));
  if (mesh.pose.rotation == Eigen::Matrix3d::Identity()) return text;
  const Eigen::Vector4d xyzw = Eigen::Quaterniond(mesh.pose.rotation).coeffs();
  return text + fmt::format(", quat_xyzw: {}", internal::yaml_numbers({xyzw.data(), 4}));
}

/// The key `attached`, where there is something.
std::string describe_attached(const Robot& robot) {
  std::string text = robot.attached().empty() ? "" : "attached:\n";
  for (const ApproximatedObject& carried : robot.attached()) {
    const AttachedObject& object = carried.object;
    std::vector<std::string> touch, shapes;
    for (const std::string& name : object.may_touch) touch.push_back(internal::yaml_string(name));
    for (const Shape& shape : object.shapes) {
      shapes.push_back(fmt::format("{{{}}}", internal::yaml_shape(shape)));
    }
    for (const MeshFile& mesh : object.meshes) {
      shapes.push_back(fmt::format("{{{}}}", describe_mesh(mesh)));
    }
    text += fmt::format("  - {{name: {}, link: {}, touch: [{}], shapes: [{}]}}\n",
                        internal::yaml_string(object.name), internal::yaml_string(object.link),
                        fmt::join(touch, ", "), fmt::join(shapes, ", "));
  }
  return text;
}

/// The key `allow`, where there is something: of a name that a link and an obstacle share, it means
/// the link where it stands first.
std::string describe_allowed(const Problem& problem) {
  std::vector<std::string> pairs;
  for (auto [first, second] : problem.allowed_pairs) {
    if (problem.scene.find(second) != nullptr) std::swap(first, second);
    if (problem.scene.find(second) != nullptr) continue;
    pairs.push_back(
        fmt::format("[{}, {}]", internal::yaml_string(first), internal::yaml_string(second)));
  }
  return pairs.empty() ? "" : fmt::format("allow: [{}]\n", fmt::join(pairs, ", "));
}

/// The key `constraints`, where there is something.
std::string describe_constraints(const Problem& problem) {
  std::string text = problem.constraints.empty() ? "" : "constraints:\n";
  for (const OrientationConstraint& constraint : problem.constraints) {
    text += fmt::format("  - {{link: {}, axis: {}, up: {}, angle: {}}}\n",
                        internal::yaml_string(constraint.link),
                        internal::yaml_numbers({constraint.axis.data(), 3}),
                        internal::yaml_numbers({constraint.up.data(), 3}), constraint.angle);
  }
  return text;
}

std::string indented(const std::string& text) {
  std::istringstream lines(text);
  std::string result;
  for (std::string line; std::getline(lines, line);) result += "  " + line + "\n";
  return result;
}

}  // namespace

std::string to_yaml(const Problem& problem, const std::string& robot) {
  std::string text = fmt::format(
      "name: {}\nrobot: {}\n{}{}{}{}scene:\n{}start: {}\n", internal::yaml_string(problem.name),
      internal::yaml_string(robot), describe_group(problem.robot), describe_attached(problem.robot),
      describe_allowed(problem), describe_constraints(problem), indented(to_yaml(problem.scene)),
      internal::yaml_numbers(problem.start));
  std::vector<std::string> goals;
  for (const Configuration& goal : problem.goals) goals.push_back(internal::yaml_numbers(goal));
  for (const PoseGoal& goal : problem.pose_goals) goals.push_back(describe_pose(goal));
  if (goals.size() == 1) return text + fmt::format("goal: {}\n", goals.front());
  text += "goals:\n";
  for (const std::string& goal : goals) text += fmt::format("  - {}\n", goal);
  return text;
}

namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Shape& shape) {
  Json json = {{"type", shape_name(shape)}};
  for (const internal::ShapeField& field :
       internal::shape_fields(shape, internal::kCompactSpelling)) {
    json[std::string(field.key)] = field.is_list ? Json(field.values) : Json(field.values[0]);
  }
  return json;
}

Json json_of(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

Json json_of(const MeshFile& mesh) {
  const Eigen::Quaterniond q(mesh.pose.rotation);
  return {{"type", "mesh"},
          {"file", mesh.path},
          {"scale", json_of(mesh.scale)},
          {"p", json_of(mesh.pose.translation)},
          {"q", {q.w(), q.x(), q.y(), q.z()}}};
}

Json json_of(const AttachedObject& object) {
  Json shapes = Json::array();
  for (const Shape& shape : object.shapes) shapes.push_back(json_of(shape));
  for (const MeshFile& mesh : object.meshes) shapes.push_back(json_of(mesh));
  return {{"name", object.name},
          {"link", object.link},
          {"touch", object.may_touch},
          {"shapes", std::move(shapes)}};
}

Json angle_json(double angle) { return angle >= std::numbers::pi ? Json("free") : Json(angle); }

Json json_of(const PoseGoal& goal) {
  const Eigen::Quaterniond q(goal.pose.rotation);
  Json json = {{"link", goal.link},
               {"position", json_of(goal.pose.translation)},
               {"quat_xyzw", {q.x(), q.y(), q.z(), q.w()}},
               {"position_tolerance", json_of(goal.position_tolerance)},
               {"axis", std::string(1, "xyz"[static_cast<int>(goal.axis)])},
               {"cone", angle_json(goal.cone)},
               {"turn", angle_json(goal.turn)}};
  if (!goal.frame.empty()) json["frame"] = goal.frame;
  return json;
}

Json json_of(const OrientationConstraint& constraint) {
  return {{"link", constraint.link},
          {"axis", json_of(constraint.axis)},
          {"up", json_of(constraint.up)},
          {"angle", constraint.angle}};
}

/// The keys of a problem that say where obstacles are.
Json json_of(const Scene& scene) {
  Json obstacles = Json::array(), allow = Json::array();
  for (const Obstacle& obstacle : scene.obstacles) {
    for (const Shape& shape : obstacle.shapes) {
      Json json = {{obstacle.shapes.size() == 1 ? "name" : "body", obstacle.name}};
      json.update(json_of(shape));
      obstacles.push_back(std::move(json));
    }
    for (const std::string& link : obstacle.may_touch) allow.push_back({link, obstacle.name});
  }
  Json json = {{"obstacles", std::move(obstacles)}};
  if (!allow.empty()) json["allow"] = std::move(allow);
  return json;
}

std::string text_of(Json file, Json problem) {
  file["problems"] = Json::array({std::move(problem)});
  return file.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

std::string to_json(const PoseGoal& goal) {
  return json_of(goal).dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string to_compact_json(const FramedScene& framed) {
  Json file = Json::object();
  if (!framed.frame.empty()) file["frame"] = framed.frame;
  Json problem = {{"name", framed.scene.name}};
  problem.update(json_of(framed.scene));
  return text_of(std::move(file), std::move(problem));
}

std::string to_compact_json(const Problem& problem, const std::string& robot) {
  const Robot& model = problem.robot;
  Json file = {{"robot", robot}};
  for (int i = 0; i < model.joint_count(); ++i) file["joints"].push_back(model.group_joint(i).name);
  for (const Joint& joint : fixed_joints(model)) {
    file["fixed_joints"][joint.name] = joint.fixed_value;
  }
  Json json = {{"name", problem.name}};
  json.update(json_of(problem.scene));
  for (const ApproximatedObject& carried : model.attached()) {
    json["attached"].push_back(json_of(carried.object));
  }
  json["start"] = problem.start;
  json["goals"] = problem.goals;
  for (const PoseGoal& goal : problem.pose_goals) json["goals"].push_back(json_of(goal));
  for (const OrientationConstraint& constraint : problem.constraints) {
    json["constraints"].push_back(json_of(constraint));
  }
  return text_of(std::move(file), std::move(json));
}

}  // namespace mneme
