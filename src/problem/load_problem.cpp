// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/problem.h"

#include "problem/compact_file.h"
#include "problem/problem_input.h"
#include "scene/scene_input.h"
#include "scene/text_file.h"
#include "scene/yaml_input.h"

#include <filesystem>

namespace mneme {
namespace {

using internal::Input;

Scene read_or_load_scene(const Input& input, const std::string& directory,
                         const std::string& default_name) {
  if (input.is_text()) {
    return internal::value_or_throw(
        load_scene((std::filesystem::path(directory) / input.text()).string()));
  }
  if (!input.is_map()) {
    input.fail_expecting("a scene, or the path of a scene file");
  }
  return internal::read_scene(input, default_name);
}

Problem read_problem_file(const std::string& path, const ProblemOptions& options) {
  const auto text = internal::value_or_throw(internal::read_text_file(path));
  const internal::InputValue value = internal::parse_yaml(text, path);
  const Input input(value, path);
  input.allow_keys({"name", "robot", "srdf", "group", "joints", "fixed_joints", "frame", "scene",
                    "start", "goal", "goals"});
  const auto named = input.find("name");
  const std::string name = named ? named->text() : std::filesystem::path(path).stem().string();
  const std::string directory = internal::directory_of(path);
  return internal::read_problem(
      {input, input, name, directory, read_or_load_scene(input.at("scene"), directory, name)},
      options);
}

}  // namespace

Result<Problem> load_problem(const std::string& where, const ProblemOptions& options) {
  return internal::without_throwing([&] {
    const auto compact = internal::split_address(where);
    return compact ? internal::read_compact_problem(*compact, options)
                   : read_problem_file(where, options);
  });
}

}  // namespace mneme
