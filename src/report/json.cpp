// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/report.h"

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include <cmath>
#include <variant>

namespace mneme::internal {
namespace {

using Json = nlohmann::ordered_json;

/// A hundredth of a millimetre, or of a milliradian: below what anybody sees.
double rounded(double value) { return std::round(value * 1e5) / 1e5 + 0.0; }

Json number(double value) { return std::isfinite(value) ? Json(rounded(value)) : Json(nullptr); }

void append(Json& list, const Vec3& p) {
  for (int i = 0; i < 3; ++i) list.push_back(rounded(p[i]));
}

Json flat(std::span<const Vec3> points) {
  Json list = Json::array();
  for (const Vec3& point : points) append(list, point);
  return list;
}

/// x, y, z, then a quaternion x, y, z, w.
Json to_json(const Transform& pose) {
  Json list = Json::array();
  append(list, pose.translation);
  const Eigen::Quaterniond turn(pose.rotation);
  for (const double value : {turn.x(), turn.y(), turn.z(), turn.w()})
    list.push_back(rounded(value));
  return list;
}

Json to_json(const PlanTrace::Poses& poses) {
  Json list = Json::array();
  for (const Transform& pose : poses) list.push_back(to_json(pose));
  return list;
}

Json to_json(const Sphere& sphere) {
  Json list = flat(std::array{sphere.center});
  list.push_back(rounded(sphere.radius));
  return list;
}

Json to_json(const Capsule& capsule) {
  Json list = flat(std::array{capsule.a, capsule.b});
  list.push_back(rounded(capsule.radius));
  return list;
}

struct AddShape {
  Json& json;
  void operator()(const Sphere& s) const { json["sphere"] = to_json(s); }
  void operator()(const Capsule& s) const { json["capsule"] = to_json(s); }
  void operator()(const Box& s) const {
    json["pose"] = to_json(s.pose);
    json["size"] = flat(std::array<Vec3, 1>{2 * s.half_extents});
  }
  void operator()(const Cylinder& s) const {
    json["pose"] = to_json(s.pose);
    json["radius"] = rounded(s.radius);
    json["length"] = rounded(s.length);
  }
  void operator()(const PointCloud& s) const {
    add_parts(s, "points", s.parts->list(),
              [](Json& list, const CloudPoint& p) { append(list, Vec3(p[0], p[1], p[2])); });
  }
  void operator()(const Mesh& s) const {
    add_parts(s, "triangles", s.parts->list(), [](Json& list, const Triangle& t) {
      for (const Vec3& p : {t.a, t.b, t.c}) append(list, p);
    });
  }
  void operator()(const Octree& s) const {
    add_parts(s, "cubes", s.parts->list(), [](Json& list, const Cube& c) {
      append(list, c.center);
      list.push_back(rounded(2 * c.half_extent));
    });
  }
  template <class Part, class Append>
  void add_parts(const Crowd<Part>& s, const char* key, const std::vector<Part>& parts,
                 const Append& append_part) const {
    json["pose"] = to_json(s.pose);
    json["radius"] = rounded(s.radius);
    Json list = Json::array();
    for (const Part& part : parts) append_part(list, part);
    json[key] = std::move(list);
  }
};

Json shape_json(const Shape& shape) {
  Json json = {{"type", shape_name(shape)}};
  std::visit(AddShape{json}, shape);
  return json;
}

Json links_json(const std::vector<Link>& links) {
  Json list = Json::array();
  for (const Link& link : links) {
    Json spheres = Json::array(), capsules = Json::array();
    for (const Sphere& sphere : link.spheres) spheres.push_back(to_json(sphere));
    for (const Capsule& capsule : link.capsules) capsules.push_back(to_json(capsule));
    list.push_back({{"name", link.name}, {"spheres", spheres}, {"capsules", capsules}});
  }
  return list;
}

Json obstacles_json(const Scene& scene) {
  Json list = Json::array();
  for (const Obstacle& obstacle : scene.obstacles) {
    Json shapes = Json::array();
    for (const Shape& shape : obstacle.shapes) shapes.push_back(shape_json(shape));
    list.push_back({{"name", obstacle.name}, {"shapes", shapes}});
  }
  return list;
}

Json waypoint_json(const PlanTrace::Waypoint& waypoint) {
  Json q = Json::array();
  for (const double value : waypoint.q) q.push_back(rounded(value));
  return {{"q", q},
          {"travelled", rounded(waypoint.travelled)},
          {"clearance", number(waypoint.clearance)},
          {"nearest", {waypoint.nearest_link, waypoint.nearest_obstacle}},
          {"tip", flat(std::array{waypoint.tip})},
          {"poses", to_json(waypoint.poses)}};
}

Json primitives_json(const std::vector<PlanTrace::Primitive>& primitives) {
  Json list = Json::array();
  for (const PlanTrace::Primitive& primitive : primitives) {
    Json errors = Json::array();
    for (const double error : primitive.similarity_errors) errors.push_back(rounded(error));
    list.push_back({{"obstacles", primitive.primitive.obstacles},
                    {"gap", number(primitive.primitive.gap)},
                    {"similarity_errors", errors},
                    {"is_learned", primitive.is_learned},
                    {"components", primitive.components},
                    {"draws", primitive.draws}});
  }
  return list;
}

Json arms_json(const std::vector<PlanTrace::Arm>& arms) {
  Json list = Json::array();
  for (const PlanTrace::Arm& arm : arms)
    list.push_back({{"origin", arm.origin}, {"points", flat(arm.points)}});
  return list;
}

Json edges_json(const std::vector<PlanTrace::Edge>& edges) {
  Json list = Json::array();
  for (const PlanTrace::Edge& edge : edges)
    list.push_back({{"graph", edge.graph}, {"tips", flat(edge.tips)}});
  return list;
}

Json plan_json(const PlanTrace& trace) {
  const SolveResult& result = trace.result;
  Json json = {{"status", to_string(result.plan.status)},
               {"solved", result.plan.is_solved()},
               {"message", result.plan.message},
               {"planner", result.planner},
               {"sampler", result.sampler},
               {"seed", result.seed},
               {"isa", to_string(result.isa)},
               {"path_length", trace.path_length}};
  json["iterations"] = result.plan.iterations;
  json["states_checked"] = result.plan.states_checked;
  json["motions_checked"] = result.plan.motions_checked;
  json["nodes"] = result.plan.nodes;
  return json;
}

Json times_json(const PlanTrace& trace) {
  const SolveResult& result = trace.result;
  return {{"load_time_s", trace.load_time_s},
          {"total_time_s", result.total_time_s},
          {"planning_time_s", result.planning_time_s},
          {"retrieval_time_s", result.gl.retrieval_time_s},
          {"learning_time_s", result.gl.learning_time_s},
          {"simplification_time_s", result.plan.simplification_time_s},
          {"verification_time_s", result.plan.verification_time_s}};
}

}  // namespace

}  // namespace mneme::internal

namespace mneme {
namespace {

using Json = nlohmann::ordered_json;

void add_clearance(Json& json, const LeastClearance& clearance) {
  json["least_clearance"] = clearance.distance;
  json["nearest_link"] = clearance.link;
  json["nearest_obstacle"] = clearance.obstacle;
}

void add_times(Json& json, const SolveResult& result, double load_time_s) {
  json["total_time_s"] = result.total_time_s;
  json["planning_time_s"] = result.planning_time_s;
  json["goal_time_s"] = result.goal_time_s;
  json["retrieval_time_s"] = result.gl.retrieval_time_s;
  json["learning_time_s"] = result.gl.learning_time_s;
  json["simplification_time_s"] = result.plan.simplification_time_s;
  json["verification_time_s"] = result.plan.verification_time_s;
  json["improvement_time_s"] = result.improvement_time_s;
  json["remembering_time_s"] = result.remembered.time_s;
  json["load_time_s"] = load_time_s;
}

Json to_json(const std::vector<Improved>& improvements) {
  Json json;
  for (const Improved& path : improvements) {
    json.push_back({{"time_s", path.time_s}, {"path_length", path.path_length}});
  }
  return json;
}

}  // namespace

std::string to_json(const Problem& problem, const SolveResult& result, double load_time_s,
                    const PathMeasures* measures, std::optional<double> duration_s) {
  Json json;
  json["problem"] = problem.name;
  json["robot"] = problem.robot.name();
  json["status"] = to_string(result.plan.status);
  json["solved"] = result.plan.is_solved();
  if (!result.plan.is_solved()) json["message"] = result.plan.message;
  json["path"] = result.plan.path;
  const Path& path = result.plan.path;
  json["path_length"] = path_length(problem.robot, path);
  json["straight_length"] = path.empty() ? 0 : problem.robot.distance(path.front(), path.back());
  if (measures != nullptr && measures->clearance) add_clearance(json, *measures->clearance);
  if (duration_s) json["duration_s"] = *duration_s;
  add_times(json, result, load_time_s);
  if (!result.improvements.empty()) json["improvements"] = to_json(result.improvements);
  json["iterations"] = result.plan.iterations;
  json["states_checked"] = result.plan.states_checked;
  json["motions_checked"] = result.plan.motions_checked;
  json["remembered"] = result.remembered.rows;
  const std::string& failure = result.remembered.failure;
  if (!failure.empty()) json["remember_failure"] = failure;
  json["primitives"] = result.gl.primitives.size();
  json["retrieved"] = result.gl.retrieved_count();
  json["components"] = result.gl.mixture ? result.gl.mixture->component_count() : 0;
  json["sampler"] = result.sampler;
  json["planner"] = result.planner;
  json["seed"] = result.seed;
  json["isa"] = to_string(result.isa);
  // Names come from files and may hold any bytes; JSON must be UTF-8.
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

std::string to_json(const PlanTrace& trace) {
  using namespace internal;
  Json json = {{"format", "mneme-trace"}, {"version", 1}};
  json["generator"] = "mneme " + std::string(version());
  json["problem"] = trace.problem;
  json["robot"] = trace.robot;
  json["is_planar"] = trace.is_planar;
  json["joints"] = trace.joints;
  json["plan"] = plan_json(trace);
  json["times"] = times_json(trace);
  json["links"] = links_json(trace.links);
  json["obstacles"] = obstacles_json(trace.scene);
  json["start"] = internal::to_json(trace.start);
  json["goals"] = Json::array();
  for (const PlanTrace::Poses& goal : trace.goals) json["goals"].push_back(internal::to_json(goal));
  json["waypoints"] = Json::array();
  for (const PlanTrace::Waypoint& waypoint : trace.waypoints)
    json["waypoints"].push_back(waypoint_json(waypoint));
  json["vertices"] = trace.vertices;
  json["primitives"] = primitives_json(trace.primitives);
  json["components"] = {{"count", trace.component_count}, {"shown", arms_json(trace.components)}};
  json["samples"] = {{"uniform_draws", trace.uniform_draws}, {"shown", arms_json(trace.samples)}};
  json["edges"] = {{"count", trace.edge_count}, {"shown", edges_json(trace.edges)}};
  // Names come from files and may hold any bytes; JSON must be UTF-8.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace mneme
