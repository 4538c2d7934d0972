// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The data of a cell: its boxes, the tree that finds them, and their paths.
#pragma once

#include "mneme/cell.h"
#include "mneme/collision.h"

#include "cell/bent_path.h"
#include "cell/branch.h"
#include "goal/link_chain.h"
#include "cell/task_frame.h"

#include <array>
#include <memory>
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
};

/// A node of the tree of boxes of tasks. Its boxes may serve only some of its tasks.
struct SplitNode {
  int parameter = -1;  ///< that is cut at `at`; -1: a leaf
  double at = 0;
  int below = -1, above = -1;
  std::vector<int> boxes;
};

/// All boxes for one start.
struct StartCell {
  std::vector<CellBox> boxes;
  std::vector<SplitNode> tree = std::vector<SplitNode>(1);
  std::vector<UnprovenBox> unproven;

  /// Calls `visit(index)` for the boxes around a task, the smallest first, until it returns true.
  template <class Visit>
  void visit_boxes(const CellTask& task, const Visit& visit) const;
};

template <class Visit>
void StartCell::visit_boxes(const CellTask& task, const Visit& visit) const {
  constexpr std::size_t kMost = 64;
  std::array<int, kMost> found;
  std::size_t count = 0;
  for (int i = 0; i >= 0;) {
    const SplitNode& node = tree[static_cast<std::size_t>(i)];
    for (const int box : node.boxes) {
      if (count < kMost) found[count++] = box;
    }
    if (node.parameter < 0) break;
    i = task[static_cast<std::size_t>(node.parameter)] <= node.at ? node.below : node.above;
  }
  while (count > 0) {
    if (visit(found[--count])) return;
  }
}

/// True if the path of the box keeps the joint limits for the task, by its model.
[[nodiscard]] bool serves(const CellBox& box, const CellTask& task, const TaskFrame& frame,
                          const LinkChain& chain);

/// 16 hexadecimal digits over what decides whether a motion is free: robot with attached objects,
/// scene, allowed contacts.
[[nodiscard]] std::string hash_world(const Problem& problem);
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
  std::string world = {};  ///< hash_world() of the region's problem
  bool is_of_this_world = true;
  std::vector<StartCell> starts = {};
  std::vector<CellProgress> progress = {};
};

/// Returns a cell without boxes.
[[nodiscard]] Result<std::shared_ptr<CellData>> make_cell_data(const CellRegion& region,
                                                               double margin);

}  // namespace mneme::internal
