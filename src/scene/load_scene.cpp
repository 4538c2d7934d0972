// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/scene.h"

#include "base/files.h"
#include "input/input.h"
#include "scene/moveit_scene.h"
#include "scene/scene_input.h"

#include <filesystem>
#include <utility>

namespace mneme {

Scene make_circle_scene(std::string name, const std::vector<std::array<double, 3>>& circles) {
  Scene scene{std::move(name), {}};
  for (const auto& [x, y, radius] : circles) {
    scene.obstacles.push_back(
        {"circle_" + std::to_string(scene.obstacles.size() + 1), {Sphere{{x, y, 0.0}, radius}}});
  }
  return scene;
}

namespace {

/// Of parts that only a problem with a motion plan request uses.
void warn_of_unused(const internal::Input& scene) {
  for (const auto& [key, list] : {std::pair("allowed_collision_matrix", "entry_names"),
                                  std::pair("allowed_collision_matrix", "default_entry_names"),
                                  std::pair("robot_state", "joint_state")}) {
    const auto part = scene.find_value(key);
    auto used = part && part->is_map() ? part->find_value(list) : std::nullopt;
    if (used && used->is_map()) used = used->find_value("name");
    if (!used || (used->is_list() && used->size() == 0)) continue;
    part->warn("is not used; name scene and request together, as in scene.yaml,request.yaml");
  }
}

Result<FramedScene> parse_framed_scene(std::string_view yaml, const std::string& source) {
  return internal::without_throwing([&] {
    const std::string name = std::filesystem::path(source).stem().string();
    if (internal::is_scene_text(yaml)) {
      return FramedScene{internal::read_scene_text(yaml, source, name), ""};
    }
    const internal::InputValue value = internal::parse_yaml(yaml, source);
    internal::InputFindings findings;
    const internal::Input input = internal::Input(value, source).collecting(findings);
    if (!internal::is_moveit_scene(input)) {
      return FramedScene{internal::read_scene(input, name), ""};
    }
    const internal::MoveitScene scene = internal::read_moveit_scene(input, name);
    for (const internal::MoveitAttached& attached : scene.state.attached) {
      attached.object.place.fail(
          ErrorCode::unsupported,
          "object \"{}\" is attached to link \"{}\"; expected a scene without attached "
          "objects, or its motion plan request too: a robot carries them",
          attached.object.obstacle.name, attached.link);
    }
    warn_of_unused(input);
    FramedScene framed = internal::place_objects(scene, internal::MoveitFrames(input, scene.state));
    findings.append_to(framed.scene.warnings);
    return framed;
  });
}

Scene without_frame(FramedScene scene) { return std::move(scene.scene); }

}  // namespace

Result<Scene> load_scene(const std::string& path) {
  return load_framed_scene(path).map(without_frame);
}

Result<FramedScene> load_framed_scene(const std::string& path) {
  const std::string text = MNEME_TRY(internal::read_text_file(path));
  FramedScene scene = MNEME_TRY(parse_framed_scene(text, path));
  scene.files = {path};
  return scene;
}

Result<Scene> parse_scene(std::string_view yaml, const std::string& source) {
  return parse_framed_scene(yaml, source).map(without_frame);
}

}  // namespace mneme
