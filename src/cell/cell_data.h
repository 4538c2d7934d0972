// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The data of a cell: its boxes, the tree that finds them, and their paths.
#pragma once

#include "mneme/cell.h"
#include "mneme/collision.h"
#include "mneme/goal.h"

#include "bent_path/bent_path.h"
#include "goal/link_chain.h"
#include "cell/split_tree.h"
#include "cell/task_frame.h"

#include <array>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <queue>
#include <string>
#include <utility>
#include <vector>

namespace mneme::internal {

/// A box of tasks with its path.
struct CellBox {
  TaskBox tasks;
  BentPath path;
  GoalShift shift;  ///< over the box, as a change of the path's goal
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
  /// Removes boxes that are not proven. Leaves that they served are not examined then.
  void drop_hints();
};

/// Boxes by the distance of a task from them, relative to the region; then by index. Walks the tree
/// as far as needed.
class NearestBoxes {
 public:
  /// Refers to its arguments.
  NearestBoxes(const StartCell& cell, const TaskFrame& frame, const CellTask& task);

  /// Returns the index of the next box, or -1.
  [[nodiscard]] int next();

 private:
  struct Place {
    double distance2;
    int node;
    TaskBox box;
    bool operator>(const Place& other) const { return distance2 > other.distance2; }
  };
  using Found = std::pair<double, int>;

  void open(const TaskBox& box, int node) { open_.push({frame_.distance2(box, task_), node, box}); }

  const StartCell& cell_;
  const TaskFrame& frame_;
  const CellTask& task_;
  std::priority_queue<Place, std::vector<Place>, std::greater<>> open_;
  std::priority_queue<Found, std::vector<Found>, std::greater<>> found_;
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

/// What proofs and answers without a proven box need.
struct CellTools {
  InverseKinematics kinematics;
  CollisionChecker checker;
};

struct CellData {
  CellRegion region;
  LinkChain chain;
  TaskFrame frame;
  double margin = 0;
  WorldHash world = {};  ///< hash_world() of the region's problem
  bool is_of_this_world = true;
  /// Obstacles that the boxes' last proof lacks; nothing if all is to be proven again.
  std::optional<Scene> changed = {};
  std::vector<StartCell> starts = {};
  std::vector<CellProgress> progress = {};
  std::uint64_t hash = 0;  ///< hash_cell(), once the boxes are there

  /// Made by the first call, which takes milliseconds: certified answers do without. Thread-safe.
  [[nodiscard]] const Result<CellTools>& make_tools() const;
  /// Precondition: make_tools() returns tools. A forged file may hold a region that has none.
  [[nodiscard]] const CellTools& tools() const { return *make_tools(); }

  struct MadeTools {
    std::once_flag once;
    std::optional<Result<CellTools>> tools;
  };
  std::shared_ptr<MadeTools> made = std::make_shared<MadeTools>();  ///< copies share them
};

/// Hashes the world, the tasks and the boxes of a cell, whatever is proven of them. Not 0.
[[nodiscard]] std::uint64_t hash_cell(const CellData& data);

/// Returns a cell without boxes.
[[nodiscard]] Result<std::shared_ptr<CellData>> make_cell_data(const CellRegion& region,
                                                               double margin);

}  // namespace mneme::internal
