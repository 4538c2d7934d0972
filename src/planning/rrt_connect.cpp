// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// RRT-Connect: Kuffner and LaValle, DOI 10.1109/ROBOT.2000.844730. Departures: several goals are
// roots of one tree; the smaller tree grows, as far towards the sample as it gets; a path whose
// motions fail verification costs the tree the failing branch, and planning goes on.
#include <algorithm>
#include <utility>

#include "mneme/planning.h"
#include "planning/planner_run.h"
#include "planning/tree.h"

namespace mneme {
namespace internal {
namespace {

class RrtConnect {
 public:
  explicit RrtConnect(PlannerRun& run) : run_(run), start_tree_(run), goal_tree_(run) {
    start_tree_.add(run.start(), -1);
    for (const std::vector<float>& goal : run.goals()) goal_tree_.add(goal, -1);
  }

  PlanResult solve() {
    std::vector<float> q(run_.start().size());
    while (run_.begin_iterations()) {
      auto [growing, other] = choose_trees();
      const Origin origin = run_.sample(q);
      const int node = grow(*growing, q);
      rejections_ = node < 0 ? rejections_ + 1 : 0;
      if (node < 0) {
        run_.report(origin, SampleOutcome::rejected);
        continue;
      }
      const std::span<const float> reached = (*growing)[node];
      const int facing = other->connect(other->nearest(reached), reached);
      run_.report(origin, facing < 0 ? SampleOutcome::extended : SampleOutcome::connected);
      if (facing < 0) continue;
      const bool is_forward = growing == &start_tree_;
      if (is_path_verified(is_forward ? node : facing, is_forward ? facing : node)) {
        return run_.finish(path_, goal_, node_count());
      }
    }
    return run_.give_up(node_count());
  }

 private:
  /// The tree to grow and the one to connect to it. The smaller tree grows, so that the one in the
  /// open does not fill up while the other one is still in a passage; after many rejections the
  /// larger one, lest it starve.
  std::pair<Tree*, Tree*> choose_trees() {
    constexpr int kPatience = 1000;
    const bool is_start_smaller = start_tree_.size() <= goal_tree_.size();
    const bool is_larger_due = rejections_ >= kPatience;
    if (is_larger_due) rejections_ = 0;
    if (is_start_smaller != is_larger_due) return {&start_tree_, &goal_tree_};
    return {&goal_tree_, &start_tree_};
  }

  /// Steps towards `q` until blocked; the last new node, or -1 if the first step is blocked.
  int grow(Tree& tree, std::span<const float> q) {
    bool is_reached = false;
    int last = tree.extend(tree.nearest(q), q, is_reached);
    for (int node = last; node >= 0 && !is_reached && !run_.must_stop();) {
      node = tree.extend(last, q, is_reached);
      if (node >= 0) last = node;
    }
    return last;
  }

  /// Joins the branches that meet at `start_node` and `goal_node`. If a motion fails verification,
  /// removes the branch behind it; the motion that joins the trees belongs to neither and is
  /// dropped.
  bool is_path_verified(int start_node, int goal_node) {
    path_ = start_tree_.path_to(start_node);
    const int start_edges = static_cast<int>(path_.size()) - 1;
    FloatPath rest = goal_tree_.path_to(goal_node);
    const int goal_edges = static_cast<int>(rest.size()) - 1;
    std::reverse(rest.begin(), rest.end());
    path_.insert(path_.end(), rest.begin(), rest.end());
    goal_ = goal_tree_.root_of(goal_node);
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
  int rejections_ = 0;  ///< in a row
  FloatPath path_;
  int goal_ = 0;
};

}  // namespace
}  // namespace internal

PlanResult rrt_connect(const CollisionChecker& checker, const PlanQuery& query,
                       const Sampler& sampler, const PlanSettings& settings) {
  internal::PlannerRun run(checker, query, sampler, settings);
  if (!run.is_ready()) return run.give_up(0);
  if (const int goal = run.find_direct_goal(); goal >= 0) {
    return run.finish({run.start(), run.goals()[static_cast<std::size_t>(goal)]}, goal, 2);
  }
  return internal::RrtConnect(run).solve();
}

}  // namespace mneme
