// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/moveit_state.h"

#include "scene/moveit_pose.h"

#include <fmt/format.h>

namespace mneme::internal {
namespace {

void refuse_attached(const Input& input) {
  for (const Input& attached : items_if_any(input, "attached_collision_objects")) {
    const auto object = attached.is_map() ? attached.find("object") : std::nullopt;
    const auto id = object && object->is_map() ? object->find("id") : std::nullopt;
    const auto link = attached.is_map() ? attached.find("link_name") : std::nullopt;
    attached.fail(ErrorCode::unsupported,
                  fmt::format("object \"{}\" is attached to link \"{}\"; expected no attached "
                              "objects: they are not supported",
                              id && id->is_text() ? id->text() : "",
                              link && link->is_text() ? link->text() : ""));
  }
}

void read_positions(const Input& input, MoveitState& state) {
  input.allow_keys({"header", "name", "position", "velocity", "effort"});
  const std::vector<Input> names = items_if_any(input, "name");
  const std::vector<Input> positions = items_if_any(input, "position");
  if (names.size() != positions.size()) {
    input.fail(ErrorCode::parse,
               fmt::format("expected one position per name, got {} names and {} positions",
                           names.size(), positions.size()));
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    const bool is_new =
        state.positions.emplace(names[i].text(), positions[i].finite_number()).second;
    if (!is_new) {
      names[i].fail(ErrorCode::parse,
                    fmt::format("expected each joint once, got {} again", names[i].text()));
    }
  }
}

void read_base(const Input& input, MoveitState& state) {
  input.allow_keys({"header", "joint_names", "transforms", "twist", "wrench"});
  const std::vector<Input> names = items_if_any(input, "joint_names");
  const std::vector<Input> transforms = items_if_any(input, "transforms");
  if (names.empty() && transforms.empty()) {
    return;
  }
  if (names.size() != 1 || transforms.size() != 1) {
    input.fail(names.size() == transforms.size() ? ErrorCode::unsupported : ErrorCode::parse,
               fmt::format("expected one virtual joint that carries the robot's root link, got {} "
                           "names and {} transforms",
                           names.size(), transforms.size()));
  }
  state.base = read_moveit_transform(transforms.front());
  state.base_frame = read_frame_id(input);
}

}  // namespace

std::vector<Input> items_if_any(const Input& input, std::string_view key) {
  const auto list = input.find(key);
  return list && !list->is_nothing() ? list->items() : std::vector<Input>();
}

std::string read_frame_id(const Input& input) {
  const auto header = input.find("header");
  const auto frame = header ? header->find("frame_id") : std::nullopt;
  if (!frame) {
    return {};
  }
  // Older files write the same frame with a slash in front.
  const std::string name = frame->text();
  return name.starts_with('/') ? name.substr(1) : name;
}

MoveitState read_moveit_state(const Input& input) {
  input.allow_keys(
      {"joint_state", "multi_dof_joint_state", "attached_collision_objects", "is_diff"});
  refuse_attached(input);
  MoveitState state;
  if (const auto joints = input.find("joint_state")) {
    read_positions(*joints, state);
  }
  if (const auto base = input.find("multi_dof_joint_state")) {
    read_base(*base, state);
  }
  return state;
}

MoveitState overlaid(MoveitState state, const MoveitState& difference) {
  for (const auto& [joint, position] : difference.positions) {
    state.positions[joint] = position;
  }
  if (difference.base) {
    state.base = difference.base;
    state.base_frame = difference.base_frame;
  }
  return state;
}

}  // namespace mneme::internal
