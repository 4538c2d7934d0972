// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "service/requests.h"

#include "base/text.h"
#include "geometry/solids.h"
#include "pipeline/settings_input.h"
#include "problem/problem_input.h"
#include "scene/scene_input.h"
#include "task_file/task_input.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace mneme::internal {
namespace {

constexpr std::size_t kMostConfigurations = 100000;

const std::string kSource = "request";

/// Parses JSON and converts it with `read`.
template <class Read>
auto read_body(std::string_view body, Read&& read) {
  return without_throwing([&] {
    const InputValue value = parse_json(body, kSource);
    return read(Input(value, kSource));
  });
}

bool read_switch(const Input& input, std::string_view key, bool otherwise) {
  const auto found = input.find(key);
  return found ? found->boolean() : otherwise;
}

void check_robot(const Input& input, const Robot& robot) {
  if (const auto named = input.find("robot"); named && named->text() != robot.name()) {
    named->fail(ErrorCode::invalid, "expected {}, the robot of this service, got \"{}\"",
                robot.name(), named->text());
  }
  const auto joints = input.find("joints");
  if (!joints) return;
  std::vector<std::string> named;
  for (const Input& name : joints->items()) named.push_back(name.text());
  const std::vector<std::string> own = robot.joint_names();
  if (named != own) {
    joints->fail(ErrorCode::invalid, "expected the joints that this service plans for, [{}]",
                 fmt::join(own, ", "));
  }
}

void check_count(const Input& input, const Scene& scene, const RequestContext& context) {
  std::size_t shapes = 0, parts = 0;
  for (const Obstacle& obstacle : scene.obstacles) {
    shapes += obstacle.shapes.size();
    for (const Shape& shape : obstacle.shapes) parts += part_count(shape);
  }
  if (shapes > static_cast<std::size_t>(context.limits.obstacles)) {
    input.fail(ErrorCode::invalid, "expected at most {} obstacles, got {}",
               context.limits.obstacles, shapes);
  }
  if (parts > static_cast<std::size_t>(context.limits.points)) {
    input.fail(ErrorCode::invalid, "expected at most {} points, triangles and cubes, got {}",
               context.limits.points, parts);
  }
}

/// Reads the keys `circles` and `obstacles`, without changing their frame.
Bodies read_framed_bodies(const Input& input, const std::string& name,
                          const RequestContext& context) {
  Bodies bodies = read_bodies(input, kRequestSpelling, name);
  check_count(input, bodies.scene, context);
  return bodies;
}

Scene find_scene(const Input& id, const RequestContext& context) {
  const SceneStore::Kept scene = context.scenes.find(id.text());
  if (scene == nullptr) {
    id.fail(ErrorCode::invalid, "there is no scene \"{}\"; PUT /v1/scenes/ID uploads one",
            id.text());
  }
  return *scene;
}

/// Applies the key `allow`: pairs of a link and an obstacle.
Scene with_allowed(const Input& input, Scene scene) {
  if (const auto allowed = input.find("allow")) read_allowed_contacts(*allowed, scene);
  return scene;
}

double read_margin(const Input& input) {
  const auto margin = input.find("margin");
  if (!margin) return 0;
  const double metres = margin->finite_number();
  if (metres < 0) margin->fail_expecting("metres, 0 or more");
  return metres;
}

/// Reads the scene of a request. Obstacles of the request come first and replace obstacles of the
/// named scene with the same names; a cloud without points removes them. Without a named scene they
/// stay in the request's frame. Without scene and obstacles it is the scene of the service's
/// problem.
Scene read_scene_of_request(const Input& input, const std::string& name,
                            const RequestContext& context) {
  Bodies own = read_framed_bodies(input, name, context);
  Scene& scene = own.scene;
  const auto id = input.find("scene");
  const std::shared_ptr<const Problem>& shown = context.limits.shown;
  const bool is_of_its_own = input.find("obstacles") || input.find("circles");
  if (!id && (is_of_its_own || shown == nullptr)) return std::move(scene);
  if (const auto frame = input.find("frame")) {
    frame->fail(ErrorCode::invalid,
                id ? "expected no frame beside scene: with a scene, all obstacles are in the frame "
                     "of the root link"
                   : "expected no frame: without scene and obstacles, a request has the scene of "
                     "the service's problem, in the frame of the root link; give obstacles, [] for "
                     "none");
  }
  Scene kept = id ? find_scene(*id, context) : Scene(shown->scene);
  for (const std::string& emptied : own.empty) static_cast<void>(kept.remove(emptied));
  scene.end_contacts = std::move(kept.end_contacts);
  for (Obstacle& obstacle : kept.obstacles) {
    const bool is_replaced = scene.find(obstacle.name) != nullptr;
    if (!is_replaced) scene.obstacles.push_back(std::move(obstacle));
  }
  check_count(input, scene, context);
  return std::move(scene);
}

void check_setting_names(const Input& settings, const SolveSettings& all,
                         const TaskSettings* task) {
  std::vector<std::string_view> names = {"planner", "sampler", "kind"};
  const auto add = [&](const char* name, const auto&, auto, auto, std::string_view) {
    const std::string_view key = name;
    if (key != "learn-budget" && key != "remember-after") names.push_back(key);
  };
  // Requests cannot learn, except by remembering their plans.
  visit_settings(all, add);
  visit_settings(all.plan, add);
  visit_settings(all.memory, add);
  visit_settings(all.ik, add);
  if (task != nullptr) visit_settings(*task, add);
  settings.allow_keys(names);
}

template <class Entry>
std::string checked_name(const Input& input, const Result<Entry>& entry) {
  if (!entry) input.fail(entry.error().code, entry.error().message);
  return input.text();
}

void read_names(const Input& input, SolveSettings& settings) {
  if (const auto planner = input.find("planner")) {
    settings.planner = checked_name(*planner, find_planner(planner->text()));
  }
  if (const auto sampler = input.find("sampler")) {
    settings.sampler = checked_name(*sampler, find_sampler(sampler->text()));
  }
  if (const auto kind = input.find("kind")) {
    settings.memory.kind = checked_name(*kind, find_memory_kind(kind->text()));
  }
}

void check_limits(const Input& input, const SolveSettings& settings,
                  const ServiceSettings& limits) {
  if (settings.plan.timeout_s + settings.plan.improve > limits.longest_plan_s) {
    input.fail(ErrorCode::invalid,
               "expected a timeout and improve of at most {} s together, the limit of this service",
               limits.longest_plan_s);
  }
  if (settings.threads > limits.threads) {
    input.at("threads").fail(ErrorCode::invalid,
                             "expected at most {} threads, the limit of this service",
                             limits.threads);
  }
  if (settings.plan.max_nodes > limits.nodes) {
    input.at("max-nodes")
        .fail(ErrorCode::invalid, "expected at most {} nodes, the limit of this service",
              limits.nodes);
  }
}

/// Reads also those of a task, if `task` is not null.
SolveSettings read_settings(const Input& request, const RequestContext& context,
                            TaskSettings* task = nullptr) {
  SolveSettings settings;
  settings.sampler = context.has_memory ? "gl" : "uniform";
  settings.plan.timeout_s = std::min(settings.plan.timeout_s, context.limits.longest_plan_s);
  settings.plan.max_nodes = context.limits.nodes;
  const auto input = request.find("settings");
  if (!input) return settings;
  check_setting_names(*input, settings, task);
  visit_all_settings(settings, SettingsReader(*input));
  if (task != nullptr) visit_settings(*task, SettingsReader(*input));
  read_names(*input, settings);
  check_limits(*input, settings, context.limits);
  return settings;
}

/// Every attached shape has many spheres, each of which is checked against all others.
void check_attached(const Input& input, const ServiceSettings& limits) {
  const auto attached = input.find("attached");
  if (!attached) return;
  std::size_t count = 0;
  for (const Input& object : attached->items()) {
    const auto shapes = object.find("shapes");
    count += shapes ? shapes->size() : 1;
  }
  if (count <= static_cast<std::size_t>(limits.attached)) return;
  attached->fail(ErrorCode::invalid,
                 "expected at most {} shapes, the limit of this service (--most-attached), got {}",
                 limits.attached, count);
}

/// Reads a problem of the service's robot from the keys of compact files.
Problem read_problem_of_request(const Input& input, const ProblemOptions& options,
                                const RequestContext& context) {
  check_robot(input, context.robot);
  check_attached(input, context.limits);
  const auto named = input.find("name");
  const std::string name = named ? named->text() : kSource;
  return read_problem_of(
      {"", context.robot, {}},
      {input, input, name, "", {read_scene_of_request(input, name, context)}, kRequestSpelling},
      options);
}

/// Reads a map of settings by name, and of no other keys than `names`.
template <class Settings>
void read_settings_map(const Input& input, Settings& settings,
                       std::vector<std::string_view> names = {}) {
  visit_settings(settings, [&](const char* name, const auto&, auto, auto, std::string_view) {
    names.push_back(name);
  });
  input.allow_keys(names);
  visit_settings(settings, SettingsReader(input));
}

/// Reads the key `trajectory`: true, or settings of trajectories by name.
std::optional<TrajectorySettings> read_timing(const Input& request) {
  const auto input = request.find("trajectory");
  if (!input) return std::nullopt;
  TrajectorySettings timing;
  if (!input->is_map()) return input->boolean() ? std::optional(timing) : std::nullopt;
  read_settings_map(*input, timing);
  return timing;
}

/// Decodes codes and + of the query of a URL.
std::string decode_query(std::string_view text) {
  std::string spaced(text);
  std::ranges::replace(spaced, '+', ' ');
  return percent_decoded(spaced);
}

/// Reads the value of a parameter as YAML would: true, false, a number or text.
InputValue to_value(std::string text) {
  if (text == "true" || text == "false") return {text == "true"};
  if (const auto number = parse_number<double>(text); number && std::isfinite(*number)) {
    return {*number};
  }
  return {InputValue::Text{std::move(text), true}};
}

/// Reads the parameters KEY=VALUE of the query of a URL, as a map.
InputValue parse_query(std::string_view query, const std::string& source) {
  InputValue::Map map;
  while (!query.empty()) {
    const std::string_view pair = query.substr(0, query.find('&'));
    query.remove_prefix(std::min(query.size(), pair.size() + 1));
    const std::size_t equals = std::min(pair.find('='), pair.size());
    const std::string key = decode_query(pair.substr(0, equals));
    InputValue value = to_value(decode_query(pair.substr(std::min(equals + 1, pair.size()))));
    if (std::ranges::find(map, key, &InputEntry::key) != map.end()) {
      Input(value, source, key).fail(ErrorCode::invalid, "expected the key once");
    }
    if (!pair.empty()) map.push_back({key, std::move(value)});
  }
  return {std::move(map)};
}

/// Reads the parameters `trajectory` and `dt`, which stand for those of the body.
void read_query(std::string_view query, std::optional<TrajectorySettings>& timing) {
  const std::string source = "query of the URL";
  const InputValue value = parse_query(query, source);
  const Input input(value, source);
  input.allow_keys({"trajectory", "dt"});
  if (const auto wanted = input.find("trajectory")) {
    if (!wanted->boolean()) timing.reset();
    if (wanted->boolean() && !timing) timing.emplace();
  }
  const auto dt = input.find("dt");
  if (!dt) return;
  if (!timing) dt->fail(ErrorCode::invalid, "no trajectory is wanted; add trajectory=true");
  visit_settings(*timing, SettingsReader(input));
}

PlanRequest read_plan(const Input& input, std::string_view query, const RequestContext& context) {
  if (const auto stages = input.find("stages")) {
    stages->fail(ErrorCode::invalid, "tasks of several stages are for POST /v1/tasks");
  }
  input.allow_keys({"name",         "index", "robot",       "joints",         "links",
                    "joint_limits", "frame", "scene",       "obstacles",      "circles",
                    "attached",     "allow", "start",       "start_velocity", "end_velocity",
                    "goal",         "goals", "constraints", "self_filter",    "settings",
                    "trajectory",   "trace", "clearance",   "remember"});
  PlanRequest request{read_problem_of_request(input, {}, context), read_settings(input, context),
                      read_timing(input)};
  read_query(query, request.timing);
  request.wants_clearance = read_switch(input, "clearance", false);
  request.wants_trace = read_switch(input, "trace", false);
  request.may_remember = read_switch(input, "remember", true);
  return request;
}

TaskRequest read_task(const Input& input, std::string_view query, const RequestContext& context) {
  input.allow_keys({"name", "robot", "joints", "frame", "scene", "obstacles", "circles", "attached",
                    "allow", "start", "start_velocity", "trajectory", "constraints", "self_filter",
                    "settings", "remember", "stages"});
  // Stages take the place of the goals.
  ProblemOptions options;
  options.goal = Configuration();
  Task task = read_task_of(read_problem_of_request(input, options, context), input);
  // Read before: g++ 12 destroys what is within inner braces twice if what follows throws.
  std::optional<TrajectorySettings> timing = read_timing(input);
  TaskRequest request{std::move(task), {}, std::move(timing)};
  request.settings.solve = read_settings(input, context, &request.settings);
  read_query(query, request.timing);
  request.may_remember = read_switch(input, "remember", true);
  return request;
}

/// Reads the start of inverse kinematics.
Configuration read_near(const Input& input, const Robot& robot) {
  const Configuration zero(static_cast<std::size_t>(robot.joint_count()), 0.0);
  const auto near = input.find("near");
  if (!near) return robot.normalized(zero);
  Configuration q = read_configuration(*near, robot);
  if (const auto violation = robot.describe_violation(q, "near")) {
    near->fail(ErrorCode::invalid, *violation);
  }
  return q;
}

IkRequest read_ik(const Input& input, const RequestContext& context) {
  input.allow_keys({"name", "robot", "joints", "frame", "scene", "obstacles", "circles", "attached",
                    "allow", "near", "goal", "goals", "margin", "settings"});
  ProblemOptions options;
  options.start = read_near(input, context.robot);
  IkRequest request{read_problem_of_request(input, options, context), {}};
  if (!request.problem.goals.empty()) {
    const auto goals = input.find("goals");
    (goals ? *goals : input.at("goal"))
        .fail_expecting("poses of links: maps with the keys link and position");
  }
  request.margin = read_margin(input);
  const auto settings = input.find("settings");
  if (!settings) return request;
  read_settings_map(*settings, request.settings, {"seed"});
  const SettingsReader read(*settings);
  read("seed", request.settings.seed, 0, ~std::uint64_t{0}, "");
  return request;
}

CheckRequest read_check(const Input& input, const RequestContext& context) {
  input.allow_keys({"robot", "joints", "frame", "scene", "obstacles", "circles", "attached",
                    "allow", "configurations", "margin"});
  // The configurations take the place of start and goals.
  ProblemOptions options;
  options.start = read_near(input, context.robot);
  options.goal = Configuration();
  CheckRequest request{read_problem_of_request(input, options, context), {}};
  const Input configurations = input.at("configurations");
  for (const Input& q : configurations.items()) request.configurations.push_back(q.numbers());
  if (request.configurations.size() > kMostConfigurations) {
    configurations.fail(ErrorCode::invalid, "expected at most {} configurations",
                        kMostConfigurations);
  }
  request.margin = read_margin(input);
  return request;
}

void remove_obstacle(const Input& name, Scene& scene) {
  if (scene.remove(name.text())) return;
  name.fail(ErrorCode::invalid, "expected the name of an obstacle of the scene, got \"{}\"",
            name.text());
}

void set_obstacle(Obstacle obstacle, Scene& scene) {
  if (Obstacle* const known = scene.find(obstacle.name)) {
    *known = std::move(obstacle);
  } else {
    scene.obstacles.push_back(std::move(obstacle));
  }
}

}  // namespace

Result<PlanRequest> read_plan_request(std::string_view body, std::string_view query,
                                      const RequestContext& context) {
  return read_body(body, [&](const Input& input) { return read_plan(input, query, context); });
}

Result<TaskRequest> read_task_request(std::string_view body, std::string_view query,
                                      const RequestContext& context) {
  return read_body(body, [&](const Input& input) { return read_task(input, query, context); });
}

Result<IkRequest> read_ik_request(std::string_view body, const RequestContext& context) {
  return read_body(body, [&](const Input& input) { return read_ik(input, context); });
}

Result<CheckRequest> read_check_request(std::string_view body, const RequestContext& context) {
  return read_body(body, [&](const Input& input) { return read_check(input, context); });
}

Result<Scene> read_scene_request(std::string_view body, const std::string& id,
                                 const RequestContext& context) {
  return read_body(body, [&](const Input& input) {
    input.allow_keys({"frame", "obstacles", "circles", "allow"});
    Scene scene = read_framed_bodies(input, id, context).scene;
    return with_allowed(input, moved(read_frame(input, context.robot), std::move(scene)));
  });
}

Result<Scene> edit_scene(std::string_view body, const Scene& scene, const RequestContext& context) {
  return read_body(body, [&](const Input& input) {
    input.allow_keys({"frame", "remove", "obstacles", "circles", "allow"});
    Scene edited = scene;
    if (const auto names = input.find("remove")) {
      for (const Input& name : names->items()) remove_obstacle(name, edited);
    }
    Bodies bodies = read_framed_bodies(input, scene.name, context);
    Scene added = moved(read_frame(input, context.robot), std::move(bodies.scene));
    for (Obstacle& obstacle : added.obstacles) set_obstacle(std::move(obstacle), edited);
    for (const std::string& name : bodies.empty) static_cast<void>(edited.remove(name));
    edited.warnings = std::move(added.warnings);
    check_count(input, edited, context);
    return with_allowed(input, std::move(edited));
  });
}

}  // namespace mneme::internal
