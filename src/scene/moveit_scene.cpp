// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/moveit_scene.h"

#include "scene/scene_builder.h"

#include <fmt/format.h>

namespace mneme::internal {
namespace {

void refuse_other_values(const Input& scene, std::string_view list, std::string_view key,
                         double expected) {
  for (const Input& item : items_if_any(scene, list)) {
    const double value = item.at(key).finite_number();
    if (value != expected) {
      item.fail(ErrorCode::unsupported,
                fmt::format("link \"{}\" has the {} {}; expected {}: others are not supported",
                            item.at("link_name").text(), key, value, expected));
    }
  }
}

}  // namespace

bool is_moveit_scene(const Input& input) {
  return input.is_map() && (input.find("world") || input.find("allowed_collision_matrix") ||
                            input.find("robot_state") || input.find("fixed_frame_transforms"));
}

MoveitScene read_moveit_scene(const Input& input, const std::string& default_name) {
  input.allow_keys({"name", "robot_state", "robot_model_name", "fixed_frame_transforms",
                    "allowed_collision_matrix", "link_padding", "link_scale", "object_colors",
                    "world", "is_diff"});
  refuse_other_values(input, "link_padding", "padding", 0);
  refuse_other_values(input, "link_scale", "scale", 1);
  MoveitScene scene;
  const auto name = input.find("name");
  scene.name = name && name->is_text() && !name->text().empty() ? name->text() : default_name;
  if (const auto robot = input.find("robot_model_name"); robot && !robot->is_nothing()) {
    scene.robot_name = robot->text();
  }
  if (const auto state = input.find("robot_state")) {
    scene.state = read_moveit_state(*state);
  }
  if (const auto world = input.find("world")) {
    scene.objects = read_moveit_objects(*world);
  }
  if (const auto is_diff = input.find("is_diff"); is_diff && is_diff->boolean()) {
    scene.warnings.push_back(
        is_diff->place("this is the difference to a scene that is not given; it is read as the "
                       "whole scene"));
  }
  return scene;
}

Scene place_objects(const MoveitScene& scene, const MoveitFrames& frames,
                    const FindLink& find_link) {
  Scene result{scene.name, {}};
  for (const MoveitObject& object : scene.objects) {
    const Transform X_RF = frames.pose_in_root(object.frame, object.place, find_link);
    result.obstacles.push_back(moved(X_RF, object.obstacle));
  }
  return result;
}

FramedScene place_objects(const MoveitScene& scene, const MoveitFrames& frames) {
  FramedScene result{{scene.name, {}}, frames.planning_frame()};
  const auto frame_of = [&](const MoveitObject& object) {
    return object.frame.empty() ? frames.planning_frame() : object.frame;
  };
  if (!scene.objects.empty()) {
    result.frame = frame_of(scene.objects.front());
  }
  for (const MoveitObject& object : scene.objects) {
    if (frame_of(object) != result.frame) {
      object.place.fail(
          ErrorCode::invalid,
          fmt::format("object \"{}\" is given in frame \"{}\", others in \"{}\"; only "
                      "a problem with a robot may have objects in several frames",
                      object.obstacle.name, frame_of(object), result.frame));
    }
    result.scene.obstacles.push_back(object.obstacle);
  }
  if (frames.X_PR() && result.frame == frames.planning_frame()) {
    result.scene = moved(frames.X_PR()->inverse(), std::move(result.scene));
    result.frame.clear();
  }
  return result;
}

}  // namespace mneme::internal
