// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/moveit_scene.h"

#include "scene/scene_input.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <span>

namespace mneme::internal {
namespace {

/// The frame of the robot's state.
std::string frame_of_state(const Input& scene) {
  const auto state = scene.find("robot_state");
  const auto joints = state ? state->find("joint_state") : std::nullopt;
  return joints ? read_frame_id(*joints) : "";
}

}  // namespace

MoveitFrames::MoveitFrames(const Input& scene, const MoveitState& state) {
  for (const Input& item : scene.items("fixed_frame_transforms")) {
    item.allow_keys({"header", "child_frame_id", "transform"});
    // Unlike elsewhere in ROS, MoveIt's transform takes coordinates in the frame of the header to
    // those in the child frame, which is always the planning frame.
    const Input target = item.at("child_frame_id");
    if (!planning_frame_.empty() && target.text() != planning_frame_) {
      target.fail(ErrorCode::parse,
                  "expected the planning frame \"{}\" as in the entries before, got "
                  "\"{}\"",
                  planning_frame_, target.text());
    }
    planning_frame_ = target.text();
    X_PF_[read_frame_id(item)] = read_moveit_transform(item.at("transform"));
  }
  const std::string& frame = state.pose_frame;
  if (planning_frame_.empty()) {
    planning_frame_ = state.poses.empty() ? frame_of_state(scene) : frame;
  }
  if (state.poses.empty()) return;
  if (state.poses.size() > 1) {
    std::vector<std::string> joints;
    for (const auto& pose : state.poses) joints.push_back(pose.first);
    scene.fail(ErrorCode::unsupported,
               "multi_dof_joint_state: expected one virtual joint that carries the robot's root "
               "link, got {}",
               fmt::join(joints, ", "));
  }
  const bool is_planning_frame = frame.empty() || frame == planning_frame_;
  const auto known = X_PF_.find(frame);
  if (!is_planning_frame && known == X_PF_.end()) {
    scene.fail(ErrorCode::invalid,
               "expected the robot's pose in the planning frame \"{}\", got one in "
               "\"{}\"",
               planning_frame_, frame);
  }
  const Transform& pose = state.poses.begin()->second;
  X_PR_ = is_planning_frame ? pose : known->second * pose;
}

Transform MoveitFrames::pose_in_root(const std::string& frame, const Input& place,
                                     const FindLink& find_link) const {
  const std::string& name = frame.empty() ? planning_frame_ : frame;
  if (const auto X_RF = find_link(name, place)) return *X_RF;
  const auto known = X_PF_.find(name);
  const bool is_planning_frame = !name.empty() && name == planning_frame_;
  if (!is_planning_frame && known == X_PF_.end()) {
    place.fail(
        ErrorCode::invalid,
        "expected a frame that is a link of the robot{} or one of the "
        "fixed_frame_transforms, got \"{}\"",
        planning_frame_.empty() ? "" : fmt::format(", the planning frame \"{}\"", planning_frame_),
        name);
  }
  Transform X_RP = X_PR_ ? X_PR_->inverse() : Transform{};
  if (const auto link = X_PR_ ? std::nullopt : find_link(planning_frame_, place)) X_RP = *link;
  return is_planning_frame ? X_RP : X_RP * known->second;
}

namespace {

void refuse_other_values(const Input& scene, std::string_view list, std::string_view key,
                         double expected) {
  for (const Input& item : scene.items(list)) {
    const double value = item.at(key).finite_number();
    if (value != expected) {
      item.fail(ErrorCode::unsupported,
                "link \"{}\" has the {} {}; expected {}: other values are not supported",
                item.at("link_name").text(), key, value, expected);
    }
  }
}

/// True for a moveit_msgs/PlanningSceneWorld or CollisionObject.
bool is_moveit_world(const Input& input) {
  return input.find("collision_objects") || (input.find("id") && input.find("operation"));
}

}  // namespace

bool is_moveit_scene(const Input& input) {
  return input.is_map() && (input.find("world") || input.find("allowed_collision_matrix") ||
                            input.find("robot_state") || input.find("fixed_frame_transforms") ||
                            is_moveit_world(input));
}

MoveitScene read_moveit_scene(const Input& input, const std::string& default_name) {
  if (is_moveit_world(input)) return {default_name, "", read_moveit_objects(input), {}};
  input.allow_keys({"name", "robot_state", "robot_model_name", "fixed_frame_transforms",
                    "allowed_collision_matrix", "link_padding", "link_scale", "object_colors",
                    "world", "is_diff"});
  refuse_other_values(input, "link_padding", "padding", 0);
  refuse_other_values(input, "link_scale", "scale", 1);
  MoveitScene scene;
  const auto name = input.find("name");
  scene.name = name && name->is_text() && !name->text().empty() ? name->text() : default_name;
  if (const auto robot = input.find_value("robot_model_name")) scene.robot_name = robot->text();
  if (const auto state = input.find("robot_state")) scene.state = read_moveit_state(*state);
  if (const auto world = input.find("world")) scene.objects = read_moveit_objects(*world);
  if (const auto is_diff = input.find("is_diff"); is_diff && is_diff->boolean()) {
    is_diff->warn("only the difference to another scene is given; it is read as the whole scene");
  }
  return scene;
}

namespace {

/// The obstacle in the root frame. Planes are centred at the point nearest to the origin.
Obstacle placed(const Transform& X_RF, const MoveitObject& object) {
  Obstacle obstacle = moved(X_RF, object.obstacle);
  for (Shape& plane : std::span(obstacle.shapes).last(object.plane_count)) {
    plane = centred_plane(std::get<Box>(plane));
  }
  return obstacle;
}

}  // namespace

Scene place_objects(const MoveitScene& scene, const MoveitFrames& frames,
                    const FindLink& find_link) {
  Scene result{scene.name, {}};
  for (const MoveitObject& object : scene.objects) {
    const Transform X_RF = frames.pose_in_root(object.frame, object.place, find_link);
    result.obstacles.push_back(placed(X_RF, object));
  }
  return result;
}

FramedScene place_objects(const MoveitScene& scene, const MoveitFrames& frames) {
  FramedScene result{{scene.name, {}}, frames.planning_frame()};
  const auto frame_of = [&](const MoveitObject& object) {
    return object.frame.empty() ? frames.planning_frame() : object.frame;
  };
  if (!scene.objects.empty()) result.frame = frame_of(scene.objects.front());
  const bool is_root_known = frames.X_PR() && result.frame == frames.planning_frame();
  const Transform X_RF = is_root_known ? frames.X_PR()->inverse() : Transform{};
  for (const MoveitObject& object : scene.objects) {
    if (frame_of(object) != result.frame) {
      object.place.fail(ErrorCode::invalid,
                        "object \"{}\" is given in frame \"{}\", others in \"{}\"; only "
                        "a problem with a robot may have objects in several frames",
                        object.obstacle.name, frame_of(object), result.frame);
    }
    result.scene.obstacles.push_back(placed(X_RF, object));
  }
  if (is_root_known) result.frame.clear();
  return result;
}

}  // namespace mneme::internal
