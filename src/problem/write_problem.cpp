// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/problem.h"

#include "scene/yaml.h"

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <sstream>

namespace mneme {
namespace {

/// The keys `joints` and `fixed_joints`. The robot's SRDF may name other joints, or several groups.
std::string describe_group(const Robot& robot) {
  std::vector<std::string> planned, fixed;
  for (int i = 0; i < robot.joint_count(); ++i) {
    planned.push_back(internal::yaml_string(robot.group_joint(i).name));
  }
  for (int i = 0; i < static_cast<int>(robot.joints().size()); ++i) {
    const Joint& joint = robot.joints()[static_cast<std::size_t>(i)];
    const bool is_planned = std::ranges::count(robot.group(), i) > 0;
    if (is_planned || joint.mimic || joint.fixed_value == 0.0) continue;
    fixed.push_back(fmt::format("{}: {}", internal::yaml_string(joint.name),
                                internal::yaml_number(joint.fixed_value)));
  }
  const std::string joints = fmt::format("joints: [{}]\n", fmt::join(planned, ", "));
  if (fixed.empty()) return joints;
  return joints + fmt::format("fixed_joints: {{{}}}\n", fmt::join(fixed, ", "));
}

std::string indented(const std::string& text) {
  std::istringstream lines(text);
  std::string result;
  for (std::string line; std::getline(lines, line);) {
    result += "  " + line + "\n";
  }
  return result;
}

}  // namespace

std::string to_yaml(const Problem& problem, const std::string& robot) {
  std::string text = fmt::format("name: {}\nrobot: {}\n{}scene:\n{}start: {}\n",
                                 internal::yaml_string(problem.name), internal::yaml_string(robot),
                                 describe_group(problem.robot), indented(to_yaml(problem.scene)),
                                 internal::yaml_numbers(problem.start));
  if (problem.goals.size() == 1) {
    return text + fmt::format("goal: {}\n", internal::yaml_numbers(problem.goals.front()));
  }
  text += "goals:\n";
  for (const Configuration& goal : problem.goals) {
    text += fmt::format("  - {}\n", internal::yaml_numbers(goal));
  }
  return text;
}

namespace {

using Json = nlohmann::ordered_json;

Json point(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

void add_pose(Json& json, const Transform& X) {
  const Eigen::Quaterniond q(X.rotation);
  json["p"] = point(X.translation);
  json["q"] = {q.w(), q.x(), q.y(), q.z()};
}

struct Describe {
  Json& json;
  void operator()(const Sphere& s) const {
    json["p"] = point(s.center);
    json["radius"] = s.radius;
  }
  void operator()(const Box& s) const {
    add_pose(json, s.pose);
    json["size"] = point(2.0 * s.half_extents);
  }
  void operator()(const Cylinder& s) const {
    add_pose(json, s.pose);
    json["radius"] = s.radius;
    json["length"] = s.length;
  }
  void operator()(const Capsule& s) const {
    json["a"] = point(s.a);
    json["b"] = point(s.b);
    json["radius"] = s.radius;
  }
};

}  // namespace

std::string to_compact_json(const FramedScene& framed) {
  Json obstacles = Json::array();
  for (const Obstacle& obstacle : framed.scene.obstacles) {
    for (const Shape& shape : obstacle.shapes) {
      Json json = {{obstacle.shapes.size() == 1 ? "name" : "body", obstacle.name},
                   {"type", shape_name(shape)}};
      std::visit(Describe{json}, shape);
      obstacles.push_back(std::move(json));
    }
  }
  Json file = Json::object();
  if (!framed.frame.empty()) file["frame"] = framed.frame;
  file["problems"] = {{{"name", framed.scene.name}, {"obstacles", std::move(obstacles)}}};
  return file.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace mneme
