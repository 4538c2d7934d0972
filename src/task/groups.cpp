// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "task/groups.h"

#include "base/as_index.h"
#include "base/fail.h"

#include <fmt/format.h>

#include <algorithm>

namespace mneme::internal {

std::string stage_name(const Task& task, int stage) {
  const Stage& at = task.stages[as_index(stage)];
  return at.name.empty() ? fmt::format("{} {}", to_string(at.kind), stage + 1) : at.name;
}

bool leads_to_line(const Stage& stage) {
  return stage.kind == StageKind::move && stage.configurations.empty() && stage.regions.empty() &&
         stage.poses.poses.empty();
}

Result<std::vector<Group>> make_groups(const Task& task) {
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
  for (Group& group : groups) {
    if (!group.move) continue;
    group.anchor = group.move;
    if (!leads_to_line(task.stages[as_index(*group.move)])) continue;
    const auto line = std::ranges::find_if(
        group.local, [&](int i) { return task.stages[as_index(i)].kind == StageKind::line; });
    const bool has_target = line != group.local.end() &&
                            !task.stages[as_index(*line)].poses.poses.empty() &&
                            task.stages[as_index(*line)].distance > 0;
    if (!has_target) {
      return fail(ErrorCode::invalid,
                  "stage '{}': it has no goal, and no line with poses, direction and distance "
                  "follows that it could lead to; give it a goal",
                  stage_name(task, *group.move));
    }
    for (auto i = group.local.begin(); i != line; ++i) {
      const StageKind kind = task.stages[as_index(*i)].kind;
      if (kind != StageKind::attach && kind != StageKind::detach) continue;
      return fail(ErrorCode::invalid,
                  "stage '{}': it stands between a move without a goal and the line that the move "
                  "leads to; put it before the move, or after the line",
                  stage_name(task, *i));
    }
    group.anchor = *line;
    group.is_line_anchor = true;
  }
  for (const Group& group : groups) {
    for (const int i : group.local) {
      const Stage& at = task.stages[as_index(i)];
      const bool leads_anywhere = at.kind == StageKind::line && !at.poses.poses.empty();
      if (!leads_anywhere || at.distance == 0 || i == group.anchor) continue;
      return fail(ErrorCode::invalid,
                  "stage '{}': the line begins where the stage before ends, so that its direction "
                  "and distance have no effect; remove them, or put 'move: next' before it",
                  stage_name(task, i));
    }
  }
  return groups;
}

}  // namespace mneme::internal
