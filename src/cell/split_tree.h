// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The tree of boxes of tasks: halves of halves of the region.
#pragma once

#include "mneme/cell.h"

#include "base/as_index.h"
#include "cell/task_frame.h"

#include <cstdint>
#include <string>
#include <vector>

namespace mneme::internal {

/// Why a leaf is not proven.
struct LeafGap {
  CellGap reason = CellGap::budget;
  bool is_examined = false;            ///< false: the reason is that of the box around it
  bool is_lost = false;                ///< boxes served the leaf until their proof failed
  std::uint16_t first = 0, other = 0;  ///< SplitTree::names
  std::uint8_t along = 0;              ///< where on the path, of kWholePath
  static constexpr int kWholePath = 255;

  /// True if the boxes of both are one box with one reason.
  [[nodiscard]] bool merges_with(const LeafGap& other_gap) const {
    return reason == other_gap.reason && first == other_gap.first && other == other_gap.other;
  }
};

/// A box of tasks. Its proven boxes may serve only some of its tasks.
struct SplitNode {
  double at = 0;   ///< the cut
  int below = -1;  ///< the first half; the other is below + 1
  int first = 0;   ///< its proven boxes are first .. first + count - 1
  std::uint16_t count = 0;
  std::uint8_t parameter = kLeaf;  ///< that is cut
  bool has_gap = false;            ///< a leaf that is not proven throughout
  LeafGap gap;

  static constexpr std::uint8_t kLeaf = kTaskSize;

  [[nodiscard]] bool is_leaf() const { return parameter == kLeaf; }
  /// A half of the node's box `whole`: 0 below the cut, 1 above it.
  [[nodiscard]] TaskBox half(const TaskBox& whole, int side) const;
  /// The half that holds a task.
  [[nodiscard]] int half_of(const CellTask& task) const {
    return task[as_index(parameter)] <= at ? below : below + 1;
  }
};

struct SplitTree {
  /// Children are behind their parent. At first nothing is examined.
  std::vector<SplitNode> nodes = {{.has_gap = true, .gap = {}}};
  std::vector<std::string> names = {""};  ///< of links and obstacles

  [[nodiscard]] const SplitNode& leaf_of(const CellTask& task) const;
  /// The boxes of all nodes in a region. Sets the nodes' cuts, which halve them.
  std::vector<TaskBox> place(const TaskBox& whole);
  /// Cuts a leaf across a parameter. Returns the first half.
  int cut(int node, int parameter, double at);
  [[nodiscard]] UnprovenBox reason_of(const LeafGap& gap) const;
  void set_gap(int node, const UnprovenBox& reason, bool is_examined);
  /// Leaves that are not proven, in a region; the largest first.
  [[nodiscard]] std::vector<UnprovenBox> unproven(const TaskFrame& frame) const;
  /// Makes one leaf of halves that are not proven for the same reason. Orders nodes by depth.
  void merge();

 private:
  std::uint16_t name_index(const std::string& name);
};

}  // namespace mneme::internal
