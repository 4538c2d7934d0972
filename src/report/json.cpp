// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/report.h"

#include <nlohmann/json.hpp>

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
  json["preparation_time_s"] = result.preparation_time_s;
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

Json to_json(const Problem& problem, const Replay& replay) {
  Json json = {{"explanation", describe_replay(problem, replay)},
               {"repaired", replay.is_repaired},
               {"iterations", replay.iterations},
               {"time_s", replay.time_s},
               {"blocked", Json::array()}};
  if (replay.is_hit()) json.update({{"row", replay.row}, {"distance", replay.distance}});
  if (replay.nearest) json["nearest"] = *replay.nearest;
  if (replay.cheap_row) json["cheap_row"] = *replay.cheap_row;
  const std::vector<Contact> contacts = find_what_blocks(problem, replay);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const BlockedPath& path = replay.blocked[i];
    Json blocked = {{"row", path.row}, {"distance", path.distance}, {"fraction", path.fraction}};
    if (!contacts[i].link.empty()) {
      blocked["link"] = contacts[i].link;
      blocked[contacts[i].is_self ? "other_link" : "obstacle"] = contacts[i].other;
    }
    json["blocked"].push_back(std::move(blocked));
  }
  return json;
}

void add_motion(Json& json, const MotionMeasures& motion) {
  json["duration_s"] = motion.duration_s;
  json["motion"] = {{"greatest_velocity", motion.velocity},
                    {"greatest_acceleration", motion.acceleration},
                    {"greatest_jerk", motion.jerk},
                    {"velocity_use", motion.velocity_use},
                    {"acceleration_use", motion.acceleration_use},
                    {"jerk_use", motion.jerk_use},
                    {"jerk_integral", motion.jerk_integral}};
}

}  // namespace

std::string to_json(const Problem& problem, const SolveResult& result, double load_time_s,
                    const PathMeasures* measures, const MotionMeasures* motion) {
  Json json;
  json["problem"] = problem.name;
  json["robot"] = problem.robot.name();
  json["status"] = to_string(result.plan.status);
  json["solved"] = result.plan.is_solved();
  if (!result.plan.is_solved()) json["message"] = result.plan.message;
  if (!result.notes.empty()) json["notes"] = result.notes;
  json["path"] = result.plan.path;
  const Path& path = result.plan.path;
  json["path_length"] = path_length(problem.robot, path);
  json["straight_length"] = path.empty() ? 0 : problem.robot.distance(path.front(), path.back());
  if (measures != nullptr && measures->clearance) add_clearance(json, *measures->clearance);
  if (motion != nullptr) add_motion(json, *motion);
  add_times(json, result, load_time_s);
  if (!result.improvements.empty()) json["improvements"] = to_json(result.improvements);
  json["iterations"] = result.plan.iterations;
  json["states_checked"] = result.plan.states_checked;
  json["motions_checked"] = result.plan.motions_checked;
  json["remembered"] = result.remembered.is_queued ? Json("queued") : Json(0);
  const std::string& failure = result.remembered.failure;
  if (!failure.empty()) json["remember_failure"] = failure;
  json["replayed"] = result.replay.is_hit();
  if (result.replay.time_s > 0) json["replay"] = to_json(problem, result.replay);
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

}  // namespace mneme
