// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// PRM: Kavraki, Svestka, Latombe and Overmars, DOI 10.1109/70.508439, grown until start and goal
// meet. As in the paper, milestones of one component are not connected again, so that the roadmap
// is a forest. Departure: each milestone also tries the components of start and goals.
#include "mneme/planning.h"

#include "planning/anchored_samples.h"
#include "planning/configuration_set.h"
#include "planning/planner_run.h"

#include <algorithm>
#include <numeric>

namespace mneme {
namespace internal {
namespace {

constexpr int kBatch = 16;  ///< samples per check: a vector of states costs as much as one

class Prm {
 public:
  explicit Prm(PlannerRun& run) : run_(run), anchored_(run), milestones_(run.space(), run.isa()) {
    add_milestone(run.start());
    add_goals(0);
  }

  PlanResult solve() {
    const std::size_t joints = run_.start().size();
    std::vector<float> batch(kBatch * joints);
    std::vector<std::uint8_t> is_valid(kBatch);
    std::vector<SampleSource> sources(kBatch);
    while (const auto count = static_cast<std::size_t>(run_.begin_iterations(kBatch))) {
      add_goals(run_.take_further_goals());
      for (std::size_t i = 0; i < count; ++i)
        sources[i] = anchored_.next(milestones_[milestones_.size() - 1],
                                    {batch.data() + i * joints, joints});
      run_.check_states({batch.data(), count * joints}, {is_valid.data(), count});
      for (std::size_t i = 0; i < count && !run_.must_stop(); ++i) {
        if (is_valid[i] == 0) {
          run_.report(sources[i], SampleOutcome::rejected);
          continue;
        }
        const int degree = add_milestone({batch.data() + i * joints, joints});
        run_.report(sources[i], degree > 1 ? SampleOutcome::connected : SampleOutcome::extended);
        if (is_goal_reached()) return run_.finish(milestones_.size());
      }
    }
    return run_.give_up(milestones_.size());
  }

 private:
  static constexpr int kStart = 0;

  /// Adds milestones for the goals from index `first` on, until a limit is reached.
  void add_goals(std::size_t first) {
    for (std::size_t i = first; i < run_.goals().size() && !run_.must_stop(); ++i) {
      ends_.push_back(milestones_.size());
      add_milestone(run_.goals()[i]);
    }
  }

  /// Connects a new milestone to near ones of other components, and to the nearest ones in the
  /// components of start and goals. Returns the number of connections. Neighbours in the same
  /// component cost no motion check, so more are found than tried. Stops where time is up.
  int add_milestone(std::span<const float> q) {
    constexpr int kFoundPerTry = 2;
    const int most_tries = std::max(1, run_.settings().neighbours);
    milestones_.measure(q);
    milestones_.find_nearest(kFoundPerTry * most_tries, neighbours_);
    const int milestone = milestones_.add(q);
    component_.push_back(milestone);
    members_.push_back({milestone});
    edges_.emplace_back();
    int degree = 0, tries = 0;
    for (const int neighbour : neighbours_) {
      if (tries == most_tries || run_.must_stop()) break;
      if (component_of(neighbour) == component_of(milestone)) continue;
      ++tries;
      degree += try_connecting(neighbour, milestone);
    }
    for (const int end : ends_) {
      if (run_.must_stop()) break;
      const int component = component_of(end);
      if (component == component_of(milestone)) continue;
      const int nearest =
          milestones_.find_nearest_of(members_[static_cast<std::size_t>(component)]);
      degree += try_connecting(nearest, milestone);
    }
    run_.count_nodes(1);  // last: the milestone that reaches the limit of nodes is connected, too
    return degree;
  }

  int try_connecting(int a, int b) {
    if (!run_.is_motion_valid(milestones_[a], milestones_[b])) return 0;
    connect(a, b);
    return 1;
  }

  void connect(int a, int b) {
    run_.show_edge(milestones_[a], milestones_[b], 0);
    edges_[static_cast<std::size_t>(a)].push_back(b);
    edges_[static_cast<std::size_t>(b)].push_back(a);
    merge(component_of(a), component_of(b));
  }

  [[nodiscard]] int component_of(int milestone) const {
    return component_[static_cast<std::size_t>(milestone)];
  }

  /// Relabels the smaller component: a milestone changes its label at most log2(size) times.
  void merge(int a, int b) {
    if (a == b) return;
    std::vector<int>* kept = &members_[static_cast<std::size_t>(a)];
    std::vector<int>* moved = &members_[static_cast<std::size_t>(b)];
    int label = a;
    if (kept->size() < moved->size()) {
      std::swap(kept, moved);
      label = b;
    }
    for (const int i : *moved) component_[static_cast<std::size_t>(i)] = label;
    kept->insert(kept->end(), moved->begin(), moved->end());
    moved->clear();
  }

  /// True if a verified path reaches a goal.
  bool is_goal_reached() {
    for (const int goal : std::span(ends_).subspan(1)) {
      while (component_of(kStart) == component_of(goal)) {
        const std::vector<int> chain = find_chain(goal);
        FloatPath path;
        for (const int i : chain) path.emplace_back(milestones_[i].begin(), milestones_[i].end());
        const int invalid = run_.find_invalid_motion(path);
        if (invalid < 0) return true;
        const auto i = static_cast<std::size_t>(invalid);
        disconnect(chain[i], chain[i + 1]);
      }
    }
    return false;
  }

  /// Milestones from the start to `target`, which is in the same component.
  [[nodiscard]] std::vector<int> find_chain(int target) const {
    std::vector<int> previous(edges_.size(), -1), queue = {kStart};
    previous[kStart] = kStart;
    for (std::size_t i = 0; i < queue.size() && previous[static_cast<std::size_t>(target)] < 0;
         ++i) {
      for (const int next : edges_[static_cast<std::size_t>(queue[i])]) {
        if (previous[static_cast<std::size_t>(next)] >= 0) continue;
        previous[static_cast<std::size_t>(next)] = queue[i];
        queue.push_back(next);
      }
    }
    std::vector<int> chain = {target};
    while (chain.back() != kStart)
      chain.push_back(previous[static_cast<std::size_t>(chain.back())]);
    std::reverse(chain.begin(), chain.end());
    return chain;
  }

  void disconnect(int a, int b) {
    std::erase(edges_[static_cast<std::size_t>(a)], b);
    std::erase(edges_[static_cast<std::size_t>(b)], a);
    std::iota(component_.begin(), component_.end(), 0);
    for (std::size_t i = 0; i < members_.size(); ++i) members_[i] = {static_cast<int>(i)};
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      for (const int j : edges_[i]) merge(component_of(j), component_[i]);
    }
  }

  PlannerRun& run_;
  AnchoredSamples anchored_;
  ConfigurationSet milestones_;
  std::vector<int> ends_ = {kStart};       ///< milestones of the start, and then of the goals
  std::vector<int> component_;             ///< label of each milestone
  std::vector<std::vector<int>> members_;  ///< milestones of each label
  std::vector<std::vector<int>> edges_;
  std::vector<int> neighbours_;
};

}  // namespace
}  // namespace internal

PlanResult prm(const PlanTask& task) { return internal::run_planner<internal::Prm>(task); }

}  // namespace mneme
