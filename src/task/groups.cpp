// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "task/groups.h"

#include "base/as_index.h"
#include "base/fail.h"

#include <fmt/format.h>

#include <algorithm>

namespace mneme::internal {
namespace {

/// Each group but the first begins with a move.
std::vector<Group> cut_before_moves(const Task& task) {
  std::vector<Group> groups;
  for (int i = 0; i < static_cast<int>(task.stages.size()); ++i) {
    const bool is_move = task.stages[as_index(i)].kind == StageKind::move;
    if (is_move || groups.empty()) groups.emplace_back();
    if (is_move) {
      groups.back().move = i;
    } else {
      groups.back().local.push_back(i);
    }
  }
  return groups;
}

/// True for a move that ends where the next line begins.
bool leads_to_line(const Stage& stage) {
  return stage.kind == StageKind::move && stage.goals.empty() && stage.poses.poses.empty();
}

/// Makes the line that a move without a goal leads to the group's anchor.
Result<void> anchor_at_line(const Task& task, Group& group) {
  const auto stage_of = [&](int i) -> const Stage& { return task.stages[as_index(i)]; };
  const auto line =
      std::ranges::find_if(group.local, [&](int i) { return stage_of(i).kind == StageKind::line; });
  const bool has_target = line != group.local.end() && !stage_of(*line).poses.poses.empty() &&
                          stage_of(*line).distance > 0;
  if (!has_target) {
    return fail(ErrorCode::invalid,
                "stage '{}': it has no goal, and no line with poses, direction and distance "
                "follows that it could lead to; give it a goal",
                stage_name(task, *group.move));
  }
  const auto between = std::find_if(group.local.begin(), line, [&](int i) {
    return stage_of(i).kind == StageKind::attach || stage_of(i).kind == StageKind::detach;
  });
  if (between != line) {
    return fail(ErrorCode::invalid,
                "stage '{}': it stands between a move without a goal and the line that the move "
                "leads to; put it before the move, or after the line",
                stage_name(task, *between));
  }
  group.anchor = *line;
  group.is_line_anchor = true;
  return {};
}

/// Error: a line with poses and a direction that is no anchor.
Result<void> check_lines(const Task& task, const Group& group) {
  for (const int i : group.local) {
    const Stage& at = task.stages[as_index(i)];
    const bool has_target = at.kind == StageKind::line && !at.poses.poses.empty();
    if (!has_target || at.distance == 0 || i == group.anchor) continue;
    return fail(ErrorCode::invalid,
                "stage '{}': the line begins where the stage before ends, so that its direction "
                "and distance have no effect; remove them, or put 'move: next' before it",
                stage_name(task, i));
  }
  return {};
}

}  // namespace

std::string stage_name(const Task& task, int stage) {
  const Stage& at = task.stages[as_index(stage)];
  return at.name.empty() ? fmt::format("{} {}", to_string(at.kind), stage + 1) : at.name;
}

Result<std::vector<Group>> make_groups(const Task& task) {
  std::vector<Group> groups = cut_before_moves(task);
  for (Group& group : groups) {
    group.anchor = group.move;
    const bool is_led = group.move && leads_to_line(task.stages[as_index(*group.move)]);
    if (is_led) MNEME_TRY(anchor_at_line(task, group));
  }
  for (const Group& group : groups) MNEME_TRY(check_lines(task, group));
  return groups;
}

}  // namespace mneme::internal
