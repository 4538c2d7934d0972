// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/report.h"

#include "geometry/solids.h"
#include "report/packed.h"

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <variant>

namespace mneme::internal {
namespace {

using Json = nlohmann::ordered_json;

/// Rounds to 0.01 mm or 0.01 mrad.
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

/// Converts each item with `to`.
template <class Items, class ToJson>
Json list_of(const Items& items, ToJson&& to) {
  Json list = Json::array();
  for (const auto& item : items) list.push_back(to(item));
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
  return list_of(poses, [](const Transform& pose) { return to_json(pose); });
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

/// Limits of points and triangles on a page; more are thinned.
constexpr std::size_t kMostPoints = 100'000;
constexpr std::size_t kMostTriangles = 60'000;
/// Least number that is kept of each shape.
constexpr std::size_t kFewest = 64;

/// Shares of triangles, and of points and cubes, that are shown.
struct Shares {
  double triangles = 1, points = 1;

  explicit Shares(std::span<const Shape* const> shapes) {
    std::size_t triangle_count = 0, point_count = 0;
    for (const Shape* shape : shapes)
      (std::holds_alternative<Mesh>(*shape) ? triangle_count : point_count) += part_count(*shape);
    triangles = share(kMostTriangles, triangle_count);
    points = share(kMostPoints, point_count);
  }
  [[nodiscard]] std::size_t most(const Shape& shape) const {
    const double part = std::holds_alternative<Mesh>(shape) ? triangles : points;
    const double most = std::floor(part * static_cast<double>(part_count(shape)));
    return std::max(kFewest, static_cast<std::size_t>(most));
  }

 private:
  static double share(std::size_t most, std::size_t count) {
    return count <= most ? 1 : static_cast<double>(most) / static_cast<double>(count);
  }
};

Json to_json(const Packed& packed) {
  Json json = {{"count", packed.count},
               {"low", {packed.low.x(), packed.low.y(), packed.low.z()}},
               {"step", packed.step},
               {"data", packed.data}};
  if (!packed.indices.empty()) json["indices"] = packed.indices;
  return json;
}

struct AddShape {
  Json& json;
  std::size_t most;
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
  void operator()(const PointCloud& s) const { add_parts("points", s); }
  void operator()(const Mesh& s) const { add_parts("triangles", s); }
  void operator()(const Octree& s) const { add_parts("cubes", s); }
  template <class Part>
  void add_parts(const char* key, const CompoundShape<Part>& s) const {
    json["pose"] = to_json(s.pose);
    json["radius"] = rounded(s.radius);
    json[key] = to_json(pack(s.parts->list(), most));
  }
};

Json shape_json(const Shape& shape, const Shares& shares) {
  Json json = {{"type", shape_name(shape)}};
  std::visit(AddShape{json, shares.most(shape)}, shape);
  return json;
}

Json looks_json(const std::vector<PlanTrace::Look>& looks, const Shares& shares) {
  return list_of(looks, [&](const PlanTrace::Look& look) {
    Json json = shape_json(look.shape, shares);
    if (!look.color.empty()) json["color"] = look.color;
    return json;
  });
}

Json links_json(const PlanTrace& trace) {
  std::vector<const Shape*> shapes;
  for (const auto& looks : trace.looks)
    for (const PlanTrace::Look& look : looks) shapes.push_back(&look.shape);
  const Shares shares(shapes);
  Json list = Json::array();
  for (std::size_t i = 0; i < trace.links.size(); ++i) {
    const Link& link = trace.links[i];
    const auto to_list = [](const auto& solid) { return to_json(solid); };
    Json json = {{"name", link.name},
                 {"spheres", list_of(link.spheres, to_list)},
                 {"capsules", list_of(link.capsules, to_list)}};
    if (!trace.looks[i].empty()) json["visual"] = looks_json(trace.looks[i], shares);
    if (!trace.carriers[i].empty()) json["carrier"] = trace.carriers[i];
    list.push_back(std::move(json));
  }
  return list;
}

Json obstacles_json(const Scene& scene) {
  std::vector<const Shape*> all;
  for (const Obstacle& obstacle : scene.obstacles)
    for (const Shape& shape : obstacle.shapes) all.push_back(&shape);
  const Shares shares(all);
  const auto to_shape = [&](const Shape& shape) { return shape_json(shape, shares); };
  return list_of(scene.obstacles, [&](const Obstacle& obstacle) -> Json {
    return {{"name", obstacle.name}, {"shapes", list_of(obstacle.shapes, to_shape)}};
  });
}

Json numbers(const std::vector<double>& values) { return list_of(values, number); }

Json limits_json(const PlanTrace::Limits& limits) {
  return {{"lower", numbers(limits.lower)},
          {"upper", numbers(limits.upper)},
          {"velocity", numbers(limits.velocity)},
          {"acceleration", numbers(limits.acceleration)}};
}

Json touches_json(const std::vector<PlanTrace::Touch>& touches) {
  return list_of(touches, [](const PlanTrace::Touch& touch) -> Json {
    return {{"goal", touch.goal},
            {"link", touch.link},
            {"other", touch.other},
            {"is_self", touch.is_self},
            {"distance", rounded(touch.distance)},
            {"place", flat(std::array{touch.place})}};
  });
}

Json waypoint_json(const PlanTrace::Waypoint& waypoint) {
  Json json = {{"q", numbers(waypoint.q)},
               {"travelled", rounded(waypoint.travelled)},
               {"clearance", number(waypoint.clearance)},
               {"nearest", {waypoint.nearest_link, waypoint.nearest_obstacle}},
               {"tip", flat(std::array{waypoint.tip})},
               {"poses", to_json(waypoint.poses)}};
  if (waypoint.velocity.empty()) return json;
  json["time"] = rounded(waypoint.time_s);
  json["velocity"] = numbers(waypoint.velocity);
  json["acceleration"] = numbers(waypoint.acceleration);
  return json;
}

Json primitives_json(const std::vector<PlanTrace::Primitive>& primitives) {
  return list_of(primitives, [](const PlanTrace::Primitive& primitive) -> Json {
    return {{"obstacles", primitive.primitive.obstacles},
            {"gap", number(primitive.primitive.gap)},
            {"similarity_errors", list_of(primitive.similarity_errors, rounded)},
            {"is_learned", primitive.is_learned},
            {"components", primitive.components},
            {"draws", primitive.sample_count}};
  });
}

Json arms_json(const std::vector<PlanTrace::Arm>& arms) {
  return list_of(arms, [](const PlanTrace::Arm& arm) -> Json {
    return {{"origin", arm.source}, {"points", flat(arm.points)}};
  });
}

Json edges_json(const std::vector<PlanTrace::Edge>& edges) {
  return list_of(edges, [](const PlanTrace::Edge& edge) -> Json {
    return {{"graph", edge.graph}, {"tips", flat(edge.tips)}};
  });
}

Json plan_json(const PlanTrace& trace) {
  const SolveResult& result = trace.result;
  return {{"status", to_string(result.plan.status)},
          {"solved", result.plan.is_solved()},
          {"message", result.plan.message},
          {"planner", result.planner},
          {"sampler", result.sampler},
          {"seed", result.seed},
          {"isa", to_string(result.isa)},
          {"path_length", trace.path_length},
          {"iterations", result.plan.iterations},
          {"states_checked", result.plan.states_checked},
          {"motions_checked", result.plan.motions_checked},
          {"nodes", result.plan.nodes}};
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
  json["limits"] = limits_json(trace.limits);
  if (trace.duration_s > 0) json["duration_s"] = rounded(trace.duration_s);
  json["links"] = links_json(trace);
  json["obstacles"] = obstacles_json(trace.scene);
  json["start"] = internal::to_json(trace.start);
  json["goals"] = list_of(trace.goals, [](const auto& poses) { return internal::to_json(poses); });
  json["touches"] = touches_json(trace.touches);
  json["waypoints"] = list_of(trace.waypoints, waypoint_json);
  json["vertices"] = trace.vertices;
  json["primitives"] = primitives_json(trace.primitives);
  json["components"] = {{"count", trace.component_count}, {"shown", arms_json(trace.components)}};
  json["samples"] = {{"uniform_draws", trace.uniform_count}, {"shown", arms_json(trace.samples)}};
  json["edges"] = {{"count", trace.edge_count}, {"shown", edges_json(trace.edges)}};
  // Names come from files and may hold any bytes; JSON must be UTF-8.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace mneme
