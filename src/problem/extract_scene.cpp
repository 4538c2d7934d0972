// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/problem.h"

#include "problem/compact_file.h"
#include "problem/moveit_problem.h"
#include "problem/moveit_request.h"
#include "problem/problem_input.h"
#include "problem/problem_robot.h"
#include "scene/scene_builder.h"
#include "base/text_file.h"
#include "scene/yaml_input.h"

#include <fmt/format.h>

#include <filesystem>

namespace mneme {
namespace {

using internal::Input;
using internal::value_or_throw;

FramedScene extract_from_yaml(const std::string& path) {
  const auto text = value_or_throw(internal::read_text_file(path));
  const internal::InputValue value = internal::parse_yaml(text, path);
  const Input input(value, path);
  if (internal::is_moveit_request(input)) {
    return value_or_throw(load_framed_scene(internal::scene_of_request(input, path)));
  }
  if (!input.is_map() || !input.find("scene")) {
    return value_or_throw(load_framed_scene(path));
  }
  const auto frame = input.find("frame");
  return {internal::read_scene_of_problem(input, path), frame ? frame->text() : ""};
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
  if (framed.frame.empty()) {
    return framed.scene;
  }
  return internal::without_throwing([&] {
    const internal::InputValue nothing;
    const Input place(nothing, framed.scene.name);
    const auto X_RF = internal::find_fixed_link(robot, framed.frame, place);
    if (!X_RF) {
      place.fail(ErrorCode::invalid, fmt::format("expected a link of robot {} as frame, got \"{}\"",
                                                 robot.name(), framed.frame));
    }
    return internal::moved(*X_RF, framed.scene);
  });
}

}  // namespace mneme
