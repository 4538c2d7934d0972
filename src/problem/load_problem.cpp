// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/problem.h"

#include "base/files.h"
#include "problem/moveit_problem.h"
#include "problem/problem_input.h"

#include <filesystem>

namespace mneme {

std::shared_ptr<ProblemCache> make_problem_cache() { return std::make_shared<ProblemCache>(); }

namespace {

using internal::Input;

/// People try their robot's URDF first.
void refuse_xml(std::string_view text, const std::string& path) {
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  if (begin == std::string_view::npos || text[begin] != '<') return;
  internal::throw_failure(
      ErrorCode::invalid,
      "{}: this is XML, such as a robot's URDF; expected a problem: a YAML file with robot, scene, "
      "start and goal",
      path);
}

/// Refuses keys of a scene where a problem has its key `scene`.
void refuse_scene(const Input& input) {
  if (input.find("scene")) return;
  for (const char* key : {"obstacles", "circles"}) {
    const auto found = input.find(key);
    if (!found) continue;
    if (input.find("start") || input.find("goal") || input.find("goals")) {
      found->fail(ErrorCode::invalid,
                  "expected it in the problem's scene, as in `scene: {{{}: ..}}`", key);
    }
    input.fail(ErrorCode::invalid,
               "this is a scene; expected a problem with robot, scene, start and goal");
  }
}

Problem read_problem_file(const std::string& path, const ProblemOptions& options) {
  const auto text = internal::value_or_throw(internal::read_text_file(path));
  refuse_xml(text, path);
  const internal::InputValue value = internal::parse_yaml(text, path);
  const Input input(value, path);
  if (internal::is_moveit_request(input)) {
    return internal::read_moveit_problem({internal::scene_of_request(input, path), path}, options);
  }
  if (internal::is_moveit_scene(input)) {
    input.fail(ErrorCode::invalid,
               "this is a planning scene without start and goal; expected its motion plan request");
  }
  refuse_scene(input);
  if (const auto stages = input.find("stages")) {
    stages->fail(
        ErrorCode::invalid,
        "this is a task; expected a problem with a goal. `mneme plan` and mneme.Task.load() "
        "take tasks");
  }
  input.allow_keys({"name", "robot", "srdf", "group", "joints", "fixed_joints", "frame", "scene",
                    "start", "start_velocity", "end_velocity", "goal", "goals", "allow", "attached",
                    "constraints", "self_filter", "region"});
  const std::string name = input.text_or("name", std::filesystem::path(path).stem().string());
  return internal::read_problem({input, input, name, internal::directory_of(path),
                                 internal::read_scene_of_problem(input, path)},
                                options);
}

}  // namespace

Result<Problem> load_problem(const std::string& where, const ProblemOptions& options) {
  return internal::without_throwing([&] {
    if (const auto compact = internal::split_address(where)) {
      return internal::read_compact_problem(*compact, options);
    }
    if (const auto pair = internal::split_moveit_address(where)) {
      return internal::read_moveit_problem(*pair, options);
    }
    return read_problem_file(where, options);
  });
}

namespace {

using internal::value_or_throw;

FramedScene extract_from_yaml(const std::string& path) {
  const auto text = value_or_throw(internal::read_text_file(path));
  if (internal::is_scene_text(text)) return value_or_throw(load_framed_scene(path));
  const internal::InputValue value = internal::parse_yaml(text, path);
  const Input input(value, path);
  if (internal::is_moveit_request(input)) {
    FramedScene scene = value_or_throw(load_framed_scene(internal::scene_of_request(input, path)));
    scene.files.push_back(path);
    return scene;
  }
  if (!input.is_map() || !input.find("scene")) return value_or_throw(load_framed_scene(path));
  FramedScene scene = internal::read_scene_of_problem(input, path);
  scene.frame = input.text_or("frame", scene.frame);
  internal::read_allowed(input, scene.scene);
  return scene;
}

}  // namespace

Result<FramedScene> extract_scene(const std::string& where) {
  return internal::without_throwing([&] {
    if (const auto compact = internal::split_address(where)) {
      return internal::extract_compact_scene(*compact);
    }
    const auto pair = internal::split_moveit_address(where);
    return pair ? value_or_throw(load_framed_scene(pair->scene)) : extract_from_yaml(where);
  });
}

Result<Scene> in_root_frame(const FramedScene& framed, const Robot& robot) {
  if (framed.frame.empty()) return framed.scene;
  return internal::without_throwing([&] {
    const internal::InputValue nothing;
    const Input place(nothing, framed.scene.name);
    return internal::moved(internal::pose_of_frame(robot, framed.frame, place), framed.scene);
  });
}

}  // namespace mneme
