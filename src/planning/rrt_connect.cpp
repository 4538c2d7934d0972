// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// RRT-Connect: Kuffner and LaValle, DOI 10.1109/ROBOT.2000.844730. Departures:
// - Several goals are roots of one tree.
// - The smaller tree grows, so that a tree in the open does not fill up while the other one is in a
//   passage. It grows towards a sample until blocked.
// - Nodes that could not be extended have bounded domains.
// - Remembered motions are appended to either tree as a whole.
// - If a motion of a path fails verification, its branch is removed and planning continues.
#include "mneme/planning.h"

#include "planning/bridges.h"
#include "planning/growth.h"
#include "planning/planner_run.h"
#include "planning/tree.h"

#include <algorithm>
#include <span>

namespace mneme {
namespace internal {
namespace {

class RrtConnect {
 public:
  explicit RrtConnect(PlannerRun& run)
      : run_(run), start_tree_(run_, 0), goal_tree_(run_, 1), growth_(run_), bridges_(run_) {
    start_tree_.add(run.start(), -1);
    for (const std::vector<float>& goal : run.goals()) goal_tree_.add(goal, -1);
  }

  PlanResult solve() {
    const bool is_solved = search();
    bridges_.report(is_solved ? path_ : FloatPath());
    return is_solved ? run_.finish(node_count()) : run_.give_up(node_count());
  }

 private:
  /// False once a limit is reached.
  bool search() {
    for (;;) {
      for (std::size_t i = run_.take_further_goals(); i < run_.goals().size(); ++i) {
        goal_tree_.add(run_.goals()[i], -1);
      }
      if (bridges_.is_due()) {
        if (run_.begin_iterations() == 0) return false;
        if (is_solved_by_bridge()) return true;
        continue;
      }
      const bool is_forward = start_tree_.size() <= goal_tree_.size();
      Tree& growing = is_forward ? start_tree_ : goal_tree_;
      Tree& other = is_forward ? goal_tree_ : start_tree_;
      if (!growth_.sample_steps(growing, target_of(is_forward))) return false;
      for (int i = 0; i < growth_.size(); ++i) {
        const int node = growth_.take(i, growing);
        if (node < 0) {
          growth_.settle(i, SampleOutcome::rejected);
          continue;
        }
        const int facing = other.connect(other.nearest(growing[node]), growing[node]);
        growth_.settle(i, facing < 0 ? SampleOutcome::extended : SampleOutcome::connected);
        if (facing < 0) continue;
        if (is_path_verified(is_forward ? node : facing, is_forward ? facing : node)) {
          return true;
        }
        // The start nodes of later steps may have been removed.
        while (++i < growth_.size()) growth_.settle(i, SampleOutcome::rejected);
      }
    }
  }

  /// Where early samples of a tree are pulled: towards the start, or the goals in turn.
  [[nodiscard]] std::span<const float> target_of(bool is_forward) const {
    const auto& goals = run_.goals();
    return is_forward ? goals[run_.iterations() % goals.size()] : run_.start();
  }

  /// Appends a remembered motion to a tree; true if this leads to a path.
  bool is_solved_by_bridge() {
    const int graph = bridges_.choose_tree();
    Tree& growing = graph == 0 ? start_tree_ : goal_tree_;
    Tree& other = graph == 0 ? goal_tree_ : start_tree_;
    const int node = bridges_.append(growing, graph);
    if (node < 0) return false;
    const int facing = other.connect(other.nearest(growing[node]), growing[node]);
    if (facing < 0) return false;
    return graph == 0 ? is_path_verified(node, facing) : is_path_verified(facing, node);
  }

  /// Joins the branches that meet at `start_node` and `goal_node`. If a motion fails verification,
  /// removes the branch after it; the motion between the trees belongs to neither.
  bool is_path_verified(int start_node, int goal_node) {
    path_ = start_tree_.path_to(start_node);
    const int start_edges = static_cast<int>(path_.size()) - 1;
    FloatPath rest = goal_tree_.path_to(goal_node);
    const int goal_edges = static_cast<int>(rest.size()) - 1;
    std::reverse(rest.begin(), rest.end());
    path_.insert(path_.end(), rest.begin(), rest.end());
    const int invalid = run_.find_invalid_motion(path_);
    if (invalid < 0) return true;
    if (invalid < start_edges) {
      start_tree_.remove(start_tree_.ancestor_at(start_node, invalid + 1));
    } else if (invalid > start_edges) {
      const int depth = goal_edges - (invalid - start_edges - 1);
      goal_tree_.remove(goal_tree_.ancestor_at(goal_node, depth));
    }
    return false;
  }

  [[nodiscard]] int node_count() const { return start_tree_.size() + goal_tree_.size(); }

  PlannerRun& run_;
  Tree start_tree_, goal_tree_;
  Growth growth_;
  Bridges bridges_;
  FloatPath path_;
};

}  // namespace
}  // namespace internal

PlanResult rrt_connect(const PlanTask& task) {
  return internal::run_planner<internal::RrtConnect>(task);
}

}  // namespace mneme
