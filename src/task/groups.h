// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A task cut before each move.
#pragma once

#include "mneme/task.h"

#include <optional>
#include <string>
#include <vector>

namespace mneme::internal {

/// A move and the stages up to the next move. A choice among poses fixes one configuration of the
/// group, its anchor; the lines around it follow from there.
struct Group {
  std::optional<int> move;  ///< index of the stage; nothing: the group begins at the task's start
  std::vector<int> local;   ///< indices of the stages after the move
  /// Index of the stage whose poses are chosen: the move, or a line after it; nothing for the first
  /// group without a move. The anchor is where this stage ends.
  std::optional<int> anchor;
  bool is_line_anchor = false;  ///< the anchor is a line: the move ends where it begins
};

/// Returns the groups of a task's stages, in order. Error: a move without a goal that no line with
/// poses follows.
[[nodiscard]] Result<std::vector<Group>> make_groups(const Task& task);

/// Returns the stage's name, or its kind and number.
[[nodiscard]] std::string stage_name(const Task& task, int stage);

}  // namespace mneme::internal
