// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/problem.h"

#include "base/as_index.h"
#include "problem/problem_input.h"
#include "robot/held_joints.h"
#include "scene/scene_input.h"
#include "input/input.h"

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <numbers>
#include <sstream>
#include <system_error>

namespace mneme {
namespace {

using Json = nlohmann::ordered_json;

/// Joints outside the group with a fixed value other than 0, and poses of planar and floating ones.
Json fixed_joints_json(const Robot& robot) {
  Json values = Json::object();
  for (int i = 0; i < static_cast<int>(robot.joints().size()); ++i) {
    const Joint& joint = robot.joints()[internal::as_index(i)];
    if (joint.held && !(joint.held->pose == Transform())) {
      values.update(internal::held_values(joint, joint.held->pose));
    }
    const bool is_planned = std::ranges::count(robot.group(), i) > 0;
    if (!is_planned && !joint.mimic && joint.fixed_value != 0.0) {
      values[joint.name] = joint.fixed_value;
    }
  }
  return values;
}

Json json_of(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

Json attached_json(const Robot& robot, const internal::ObstacleSpelling& spelling) {
  Json objects = Json::array();
  for (const ApproximatedObject& carried : robot.attached()) {
    const AttachedObject& object = carried.object;
    Json shapes = Json::array();
    for (const Shape& shape : object.shapes) {
      shapes.push_back(internal::shape_json(shape, spelling));
    }
    for (const MeshFile& mesh : object.meshes) {
      shapes.push_back({{"type", "mesh"}, {"file", mesh.path}, {"scale", json_of(mesh.scale)}});
      shapes.back().update(internal::pose_json(mesh.pose, spelling));
    }
    objects.push_back({{"name", object.name},
                       {"link", object.link},
                       {"touch", object.may_touch},
                       {"shapes", std::move(shapes)}});
  }
  return objects;
}

void make_paths_absolute(Json& attached) {
  for (Json& object : attached) {
    for (Json& shape : object["shapes"]) {
      if (!shape.contains("file")) continue;
      std::error_code ignored;
      const auto path = std::filesystem::absolute(shape["file"].get<std::string>(), ignored);
      if (!path.empty()) shape["file"] = path.string();
    }
  }
}

Json angle_json(double angle) { return angle >= std::numbers::pi ? Json("free") : Json(angle); }

Json json_of(const PoseGoal& goal) {
  const Eigen::Quaterniond q(goal.pose.rotation);
  Json json = {{"link", goal.link},
               {"position", json_of(goal.pose.translation)},
               {"quat_xyzw", {q.x(), q.y(), q.z(), q.w()}},
               {"position_tolerance", json_of(goal.position_tolerance)},
               {"axis", to_string(goal.axis)},
               {"cone", angle_json(goal.cone)},
               {"turn", angle_json(goal.turn)}};
  if (!goal.frame.empty()) json["frame"] = goal.frame;
  return json;
}

Json goals_json(const Problem& problem) {
  Json goals = problem.goals;
  for (const PoseGoal& goal : problem.pose_goals) goals.push_back(json_of(goal));
  return goals;
}

/// The velocities at start and goal, if there are any.
Json velocities_json(const Problem& problem) {
  Json velocities = Json::object();
  if (!problem.start_velocity.empty()) velocities["start_velocity"] = problem.start_velocity;
  if (!problem.end_velocity.empty()) velocities["end_velocity"] = problem.end_velocity;
  return velocities;
}

/// Pairs of links for the key `allow`. A name that a link and an obstacle share comes first, where
/// it means the link.
Json allowed_links_json(const Problem& problem) {
  Json pairs = Json::array();
  for (auto [first, second] : problem.allowed_pairs) {
    if (problem.scene.find(second) != nullptr) std::swap(first, second);
    if (problem.scene.find(second) == nullptr) pairs.push_back({first, second});
  }
  return pairs;
}

std::string indented(const std::string& text) {
  std::istringstream lines(text);
  std::string result;
  for (std::string line; std::getline(lines, line);) result += "  " + line + "\n";
  return result;
}

}  // namespace

nlohmann::ordered_json internal::constraints_json(const Problem& problem) {
  Json constraints = Json::array();
  for (const OrientationConstraint& constraint : problem.constraints) {
    constraints.push_back({{"link", constraint.link},
                           {"axis", json_of(constraint.axis)},
                           {"up", json_of(constraint.up)},
                           {"angle", constraint.angle}});
  }
  return constraints;
}

std::string to_yaml(const Problem& problem, const std::string& robot) {
  using internal::yaml_flow;
  // The robot's SRDF may name other joints, or several groups.
  std::string text =
      fmt::format("name: {}\nrobot: {}\njoints: {}\n", internal::yaml_string(problem.name),
                  internal::yaml_string(robot), yaml_flow(problem.robot.joint_names()));
  const Json fixed = fixed_joints_json(problem.robot);
  if (!fixed.empty()) text += fmt::format("fixed_joints: {}\n", yaml_flow(fixed));
  Json attached = attached_json(problem.robot, internal::kSceneSpelling);
  make_paths_absolute(attached);
  text += internal::yaml_list("attached", attached);
  const Json allowed = allowed_links_json(problem);
  if (!allowed.empty()) text += fmt::format("allow: {}\n", yaml_flow(allowed));
  text += internal::yaml_list("constraints", internal::constraints_json(problem));
  text += fmt::format("scene:\n{}start: {}\n", indented(to_yaml(problem.scene)),
                      yaml_flow(problem.start));
  const Json velocities = velocities_json(problem);
  for (const auto& [key, velocity] : velocities.items()) {
    text += fmt::format("{}: {}\n", key, yaml_flow(velocity));
  }
  const Json goals = goals_json(problem);
  if (goals.size() == 1) return text + fmt::format("goal: {}\n", yaml_flow(goals.front()));
  return text + internal::yaml_list("goals", goals);
}

namespace {

/// The keys of a problem for obstacles and allowed contacts.
Json json_of(const Scene& scene) {
  Json json = {{"obstacles", internal::obstacles_json(scene, internal::kCompactSpelling)}};
  const Json allowed = internal::allowed_json(scene);
  if (!allowed.empty()) json["allow"] = allowed;
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
  Json file = {{"robot", robot}, {"joints", problem.robot.joint_names()}};
  const Json fixed = fixed_joints_json(problem.robot);
  if (!fixed.empty()) file["fixed_joints"] = fixed;
  Json json = {{"name", problem.name}};
  json.update(json_of(problem.scene));
  const Json links = robot.empty() ? Json::array() : allowed_links_json(problem);
  for (const Json& pair : links) json["allow"].push_back(pair);
  const Json attached = attached_json(problem.robot, internal::kCompactSpelling);
  if (!attached.empty()) json["attached"] = attached;
  json["start"] = problem.start;
  json.update(velocities_json(problem));
  json["goals"] = goals_json(problem);
  const Json constraints = internal::constraints_json(problem);
  if (!constraints.empty()) json["constraints"] = constraints;
  return text_of(std::move(file), std::move(json));
}

}  // namespace mneme
