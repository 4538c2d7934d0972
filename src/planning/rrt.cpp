// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// RRT with goal bias: LaValle and Kuffner, DOI 10.1177/02783640122067453.
#include "mneme/planning.h"

#include "planning/planner_run.h"
#include "planning/tree.h"

#include <algorithm>

namespace mneme {
namespace internal {
namespace {

class Rrt {
 public:
  explicit Rrt(PlannerRun& run)
      : run_(run),
        tree_(run),
        rng_(run.make_rng(Chance::goals)),
        tried_from_(run.goals().size(), -1) {
    tree_.add(run.start(), -1);
  }

  PlanResult solve() {
    std::vector<float> q(run_.start().size());
    while (run_.begin_iterations()) {
      int goal = draw_goal();
      int node = goal >= 0 ? untried_node_near(goal) : -1;
      if (node < 0) {
        goal = -1;
        node = grow(q);
        if (node < 0) continue;
      }
      const int reached_goal = goal >= 0 ? goal : nearest_goal_in_range(node);
      if (reached_goal >= 0 && is_goal_reached(node, reached_goal)) {
        return run_.finish(tree_.size());
      }
    }
    return run_.give_up(tree_.size());
  }

 private:
  /// A goal instead of a sample, as often as the goal bias says, otherwise -1.
  int draw_goal() {
    if (rng_.uniform() >= run_.settings().goal_bias) return -1;
    return static_cast<int>(rng_.index(static_cast<std::uint32_t>(run_.goals().size())));
  }

  /// The node nearest to a goal, or -1 if that node has been tried: it would be blocked again.
  int untried_node_near(int goal) {
    const auto i = static_cast<std::size_t>(goal);
    const int node = tree_.nearest(run_.goals()[i]);
    if (node == tried_from_[i]) return -1;
    tried_from_[i] = node;
    return node;
  }

  /// One step towards a sample; the new node or -1.
  int grow(std::vector<float>& q) {
    const Origin origin = run_.sample(q);
    bool is_reached = false;
    const int node = tree_.extend(tree_.nearest(q), q, is_reached);
    run_.report(origin, node < 0 ? SampleOutcome::rejected : SampleOutcome::extended);
    return node;
  }

  int nearest_goal_in_range(int node) {
    std::vector<float> delta(run_.start().size());
    for (std::size_t i = 0; i < run_.goals().size(); ++i) {
      const float length =
          run_.space().difference(tree_[node].data(), run_.goals()[i].data(), delta.data());
      if (length <= run_.range()) return static_cast<int>(i);
    }
    return -1;
  }

  /// Goes towards the goal as far as it gets; true if the path to it survives verification.
  bool is_goal_reached(int node, int goal) {
    const std::vector<float>& target = run_.goals()[static_cast<std::size_t>(goal)];
    const int last = tree_.connect(node, target);
    if (last < 0) return false;
    path_ = tree_.path_to(last);
    path_.push_back(target);
    const int invalid = run_.find_invalid_motion(path_);
    if (invalid < 0) return true;
    if (invalid + 2 < static_cast<int>(path_.size())) {
      tree_.remove(tree_.ancestor_at(last, invalid + 1));
      std::fill(tried_from_.begin(), tried_from_.end(), -1);
    }
    return false;
  }

  PlannerRun& run_;
  Tree tree_;
  Rng rng_;
  std::vector<int> tried_from_;  ///< per goal the node that was last extended towards it
  FloatPath path_;
};

}  // namespace
}  // namespace internal

PlanResult rrt(const PlanTask& task) { return internal::run_planner<internal::Rrt>(task); }

}  // namespace mneme
