// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The data of a cell: its boxes, the tree that finds them, and their paths.
#pragma once

#include "mneme/cell.h"
#include "mneme/collision.h"

#include "cell/bent_path.h"
#include "cell/branch.h"
#include "goal/link_chain.h"
#include "cell/split_tree.h"
#include "cell/task_frame.h"

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace mneme::internal {

/// A box of tasks with its path.
struct CellBox {
  TaskBox tasks;
  Branch branch;
  BentPath path;
  GoalShift shift;  ///< over the box, as a change of branch.q0
  int origin = 0;   ///< the box whose planned path this one bends; itself if it was planned
  bool is_proven = true;
  bool was_proven = true;  ///< is free of links and of all obstacles but CellData::changed
};

/// All boxes for one start.
struct StartCell {
  std::vector<CellBox> boxes;
  SplitTree tree;

  /// Calls `visit(index)` for the boxes around a task, the smallest first, until it returns true.
  template <class Visit>
  void visit_boxes(const CellTask& task, const Visit& visit) const {
    constexpr std::size_t kMost = 64;
    std::array<int, kMost> found;
    std::size_t count = 0;
    for (int i = 0; i >= 0;) {
      const SplitNode& node = tree.nodes[as_index(i)];
      for (int k = 0; k < node.count && count < kMost; ++k) found[count++] = node.first + k;
      if (node.is_leaf()) break;
      i = node.half_of(task);
    }
    while (count > 0 && !visit(found[--count])) continue;
  }
  /// Indices of at most `most` > 0 boxes by the distance of the task from them, relative to the
  /// region; then by index. Cost: a best-first walk of the tree.
  [[nodiscard]] std::vector<int> nearest(const CellTask& task, const TaskFrame& frame,
                                         std::size_t most) const;
  /// Removes boxes that are not proven. Leaves that they served are not examined then.
  void drop_hints();
};

/// True if the path of the box keeps the joint limits for the task, by its model.
[[nodiscard]] bool serves(const CellBox& box, const CellTask& task, const TaskFrame& frame,
                          const LinkChain& chain);

/// Hashes over what decides whether a motion is free: 16 hexadecimal digits each.
struct WorldHash {
  std::string robot;                   ///< with attached objects
  std::vector<std::string> obstacles;  ///< with contacts that they are allowed
  bool operator==(const WorldHash&) const = default;
};
[[nodiscard]] WorldHash hash_world(const Problem& problem);
/// The same over the region's tasks and starts.
[[nodiscard]] std::string hash_tasks(const CellRegion& region);

/// Errors: unsupported, for what no box can be proven with.
[[nodiscard]] Result<void> check_region(const CellRegion& region);

struct CellData {
  CellRegion region;
  LinkChain chain;
  TaskFrame frame;
  CollisionChecker checker;
  double margin = 0;
  WorldHash world = {};  ///< hash_world() of the region's problem
  bool is_of_this_world = true;
  /// Obstacles that the boxes' last proof lacks; nothing if all is to be proven again.
  std::optional<Scene> changed = {};
  std::vector<StartCell> starts = {};
  std::vector<CellProgress> progress = {};
};

/// Returns a cell without boxes.
[[nodiscard]] Result<std::shared_ptr<CellData>> make_cell_data(const CellRegion& region,
                                                               double margin);

}  // namespace mneme::internal
