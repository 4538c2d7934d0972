// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "task/look_ahead.h"

#include "base/as_index.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <utility>

namespace mneme::internal {
namespace {

/// True if stages up to the next group's choice may change what the hand touches.
bool changes_before_next(const Task& task, const Group& group, const Group& next) {
  const auto changes = [&](int i) {
    const StageKind kind = task.stages[as_index(i)].kind;
    return kind == StageKind::allow || kind == StageKind::gripper || kind == StageKind::detach;
  };
  const auto end =
      next.is_line_anchor ? std::ranges::find(next.local, *next.anchor) : next.local.begin();
  return std::ranges::any_of(group.local, changes) || std::any_of(next.local.begin(), end, changes);
}

/// True if `link` takes the object where the group's choice has brought it.
bool is_taken_at_choice(const Task& task, const Group& group, const std::string& object,
                        const std::string& link) {
  const auto stage = [&](int i) -> const Stage& { return task.stages[as_index(i)]; };
  const auto attach = std::ranges::find_if(group.local, [&](int i) {
    return stage(i).kind == StageKind::attach && stage(i).object == object;
  });
  if (attach == group.local.end() || stage(*attach).carrier != link) return false;
  // A line moves the hand on.
  return std::none_of(group.local.begin(), attach, [&](int i) {
    return i != *group.anchor && stage(i).kind == StageKind::line;
  });
}

}  // namespace

std::optional<LookAhead> LookAhead::make(TaskRun& run, const Group& group, const Group& next,
                                         const World& world, const std::string& link) {
  if (!next.anchor || changes_before_next(run.task, group, next)) return std::nullopt;
  const PoseChoice& choice = run.task.stages[as_index(*next.anchor)].poses;
  const auto pose = world.poses.find(choice.object);
  if (choice.object.empty() || pose == world.poses.end() || choice.link != link) {
    return std::nullopt;
  }
  if (!is_taken_at_choice(run.task, group, choice.object, link)) return std::nullopt;
  World without = world;
  without.held[choice.object] = {};  // the object's own frame as the link's: poses are the object's
  if (!without.scene.remove(choice.object)) return std::nullopt;
  LookAhead ahead(pose->second.inverse(), Reach(world.robot, link));
  ahead.link_ = link;
  ahead.stage_ = stage_name(run.task, *next.anchor);
  ahead.places_ = link_targets(without, choice, run.start_poses);
  ahead.hand_ = FloatingBody::of_link(without.robot, without.scene, link, run.body_settings());
  ahead.drop_blocked(run, world, choice.object);
  return ahead;
}

/// Drops places where the object alone is not free.
void LookAhead::drop_blocked(TaskRun& run, const World& world, const std::string& object) {
  World held = world;
  let_obstacles_touch(held, object);
  const auto body = FloatingBody::of_obstacle(world.robot, held.scene, object,
                                              world.poses.at(object), run.body_settings());
  if (!body) return;
  run.states += places_.size();
  run.has_tried = run.has_tried || body->has_surfaces();
  const std::vector<std::uint8_t> is_free = body->find_free(places_);
  std::vector<Transform> left, blocked;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    (is_free[i] ? left : blocked).push_back(places_[i]);
  }
  if (!blocked.empty()) what_ = body->describe_contact(blocked.front());
  places_ = std::move(left);
}

std::optional<Failure> LookAhead::find_failure(TaskRun& run, const Transform& X_WL,
                                               bool has_reason) const {
  const Transform X_OL = X_OW_ * X_WL;
  std::vector<Transform> hands;
  for (const Transform& place : places_) {
    const Transform X_PL = place * X_OL;
    if (reach_.contains(X_PL)) hands.push_back(X_PL);
  }
  std::string what = fmt::format("link '{}' does not reach", link_);
  if (places_.empty()) {
    what = what_;
  } else if (!hands.empty()) {
    if (!hand_) return std::nullopt;
    run.states += hands.size();
    run.has_tried = run.has_tried || hand_->has_surfaces();
    if (std::ranges::count(hand_->find_free(hands), 1) > 0) return std::nullopt;
    what = has_reason ? hand_->describe_contact(hands.front()) : "";
  }
  if (!what.empty()) what += fmt::format(" at each pose of '{}'", stage_);
  return Failure{DropReason::place, std::move(what)};
}

}  // namespace mneme::internal
