// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/problem.h"

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

namespace mneme {
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
