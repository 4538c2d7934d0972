// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// RRT with goal bias: LaValle and Kuffner, DOI 10.1177/02783640122067453. Departure: a node that
// grew towards a sample of memory tries to reach each goal, because memory leads through passages.
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
        rng_(run.make_rng(RngStream::goals)),
        tried_from_(run.goals().size(), -1) {
    tree_.add(run.start(), -1);
  }

  PlanResult solve() {
    std::vector<float> q(run_.start().size());
    while (run_.begin_iterations()) {
      static_cast<void>(run_.take_further_goals());
      tried_from_.resize(run_.goals().size(), -1);
      const int goal = sample_goal();
      const int node = goal >= 0 ? untried_node_near(goal) : -1;
      if (node >= 0 ? is_goal_reached(node, goal) : is_goal_reached_by_growing(q)) {
        return run_.finish(tree_.size());
      }
    }
    return run_.give_up(tree_.size());
  }

 private:
  /// A random goal with the probability of the goal bias, otherwise -1.
  int sample_goal() {
    if (rng_.uniform() >= run_.settings().goal_bias) return -1;
    return static_cast<int>(rng_.index(static_cast<std::uint32_t>(run_.goals().size())));
  }

  /// The node nearest to a goal, or -1 if it has been tried before.
  int untried_node_near(int goal) {
    const auto i = static_cast<std::size_t>(goal);
    const int node = tree_.nearest(run_.goals()[i]);
    if (node == tried_from_[i]) return -1;
    tried_from_[i] = node;
    return node;
  }

  /// Steps towards a sample, then tries goals from the new node.
  bool is_goal_reached_by_growing(std::vector<float>& q) {
    const SampleSource source = run_.sample(q);
    bool is_sample_reached = false;
    const int node = tree_.extend(tree_.nearest(q), q, is_sample_reached);
    const bool is_reached = node >= 0 && is_any_goal_reached(node, source != kUniformSource);
    run_.report(source, node < 0     ? SampleOutcome::rejected
                        : is_reached ? SampleOutcome::connected
                                     : SampleOutcome::extended);
    return is_reached;
  }

  /// Tries the goals within one step, or all of them.
  bool is_any_goal_reached(int node, bool tries_all) {
    const int removals = removals_;
    for (int goal = 0; goal < static_cast<int>(run_.goals().size()); ++goal) {
      if (!tries_all && !is_in_range(node, goal)) continue;
      if (is_goal_reached(node, goal)) return true;
      // The node may have been removed or renumbered.
      if (removals_ != removals || run_.must_stop()) return false;
    }
    return false;
  }

  [[nodiscard]] bool is_in_range(int node, int goal) {
    delta_.resize(run_.start().size());
    const std::vector<float>& target = run_.goals()[static_cast<std::size_t>(goal)];
    return run_.space().difference(tree_[node].data(), target.data(), delta_.data()) <=
           run_.range();
  }

  /// Extends towards the goal until blocked; true if a path to it passes verification.
  bool is_goal_reached(int node, int goal) {
    const std::vector<float>& target = run_.goals()[static_cast<std::size_t>(goal)];
    const int last = tree_.connect(node, target);
    if (last < 0) return false;
    FloatPath path = tree_.path_to(last);
    path.push_back(target);
    const int invalid = run_.find_invalid_motion(path);
    if (invalid < 0) return true;
    if (invalid + 2 < static_cast<int>(path.size())) {
      tree_.remove(tree_.ancestor_at(last, invalid + 1));
      ++removals_;
      std::fill(tried_from_.begin(), tried_from_.end(), -1);
    }
    return false;
  }

  PlannerRun& run_;
  Tree tree_;
  Rng rng_;
  std::vector<int> tried_from_;  ///< per goal the last node extended towards it
  int removals_ = 0;             ///< number of removed branches, which failed verification
  std::vector<float> delta_;
};

}  // namespace
}  // namespace internal

PlanResult rrt(const PlanTask& task) { return internal::run_planner<internal::Rrt>(task); }

}  // namespace mneme
