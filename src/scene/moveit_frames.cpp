// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/moveit_frames.h"

#include "scene/moveit_pose.h"

#include <fmt/format.h>

namespace mneme::internal {
namespace {

/// The frame in which the scene says that the robot's state is given.
std::string frame_of_state(const Input& scene) {
  const auto state = scene.find("robot_state");
  const auto joints = state ? state->find("joint_state") : std::nullopt;
  return joints ? read_frame_id(*joints) : "";
}

}  // namespace

MoveitFrames::MoveitFrames(const Input& scene, const MoveitState& state) {
  for (const Input& item : items_if_any(scene, "fixed_frame_transforms")) {
    item.allow_keys({"header", "child_frame_id", "transform"});
    // Unlike elsewhere in ROS, MoveIt's transform takes coordinates in the frame of the header to
    // those in the child frame, which is always the planning frame.
    const Input target = item.at("child_frame_id");
    if (!planning_frame_.empty() && target.text() != planning_frame_) {
      target.fail(ErrorCode::parse,
                  fmt::format("expected the planning frame \"{}\" as in the entries before, got "
                              "\"{}\"",
                              planning_frame_, target.text()));
    }
    planning_frame_ = target.text();
    X_PF_[read_frame_id(item)] = read_moveit_transform(item.at("transform"));
  }
  if (planning_frame_.empty()) {
    planning_frame_ = state.base ? state.base_frame : frame_of_state(scene);
  }
  if (!state.base) {
    return;
  }
  const bool is_planning_frame = state.base_frame.empty() || state.base_frame == planning_frame_;
  const auto known = X_PF_.find(state.base_frame);
  if (!is_planning_frame && known == X_PF_.end()) {
    scene.fail(ErrorCode::invalid,
               fmt::format("expected the robot's pose in the planning frame \"{}\", got one in "
                           "\"{}\"",
                           planning_frame_, state.base_frame));
  }
  X_PR_ = is_planning_frame ? *state.base : known->second * *state.base;
}

Transform MoveitFrames::pose_in_root(const std::string& frame, const Input& place,
                                     const FindLink& find_link) const {
  const std::string& name = frame.empty() ? planning_frame_ : frame;
  if (const auto X_RF = find_link(name, place)) {
    return *X_RF;
  }
  const auto known = X_PF_.find(name);
  const bool is_planning_frame = !name.empty() && name == planning_frame_;
  if (!is_planning_frame && known == X_PF_.end()) {
    place.fail(
        ErrorCode::invalid,
        fmt::format("expected a frame that is a link of the robot, the planning frame \"{}\" "
                    "or one of the fixed_frame_transforms, got \"{}\"",
                    planning_frame_, name));
  }
  Transform X_RP = X_PR_ ? X_PR_->inverse() : Transform{};
  if (const auto link = X_PR_ ? std::nullopt : find_link(planning_frame_, place)) {
    X_RP = *link;
  }
  return is_planning_frame ? X_RP : X_RP * known->second;
}

}  // namespace mneme::internal
