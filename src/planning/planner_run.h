// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The shared part of all planners: limits, counters, and finishing of paths.
#pragma once

#include "mneme/planning.h"

#include "robot/joint_space.h"

#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace mneme::internal {

using FloatPath = std::vector<std::vector<float>>;

/// Random streams of one run. Smaller numbers belong to the sampler.
enum class RngStream : std::uint64_t { goals = 16, relief, anchors, walks, bridges };

/// One call of a planner. Not thread-safe.
class PlannerRun {
 public:
  explicit PlannerRun(const PlanTask& task);
  PlannerRun(const PlannerRun&) = delete;
  PlannerRun& operator=(const PlannerRun&) = delete;

  [[nodiscard]] const JointSpace& space() const { return space_; }
  /// Length of a step. Unless PlanSettings::range is set, longer early in a search and shorter late
  /// in it.
  [[nodiscard]] float range() const {
    if (is_early()) return range_ / kEarlyRefinement;
    return is_long_search() ? long_range_ : range_;
  }
  /// Squared radius of a tree node's domain after it could not be extended; infinite for planar
  /// arms, which find passages faster without domains.
  [[nodiscard]] float first_domain() const { return first_domain_; }
  /// True once a spatial arm has searched so long that its passage must be narrow. Domains are
  /// ignored then, because they may exclude the passage.
  [[nodiscard]] bool is_long_search() const {
    return result_.iterations > kLongSearch && std::isfinite(first_domain_);
  }
  /// True in the first iterations, in which easy problems end. Never for planar arms, for robots of
  /// many joints, and where a range or a resolution is set.
  [[nodiscard]] bool is_early() const { return result_.iterations < early_iterations_; }
  [[nodiscard]] const PlanSettings& settings() const { return settings_; }
  [[nodiscard]] Rng make_rng(RngStream stream) const {
    return Rng(derive_seed(settings_.seed, static_cast<std::uint64_t>(stream)));
  }
  [[nodiscard]] Isa isa() const { return checker_.isa(); }
  [[nodiscard]] const std::vector<float>& start() const { return start_; }
  [[nodiscard]] const FloatPath& goals() const { return goals_; }
  /// Adds further goals every kGoalPeriod iterations, up to kMostGoals. Returns the index of the
  /// first new one in goals().
  [[nodiscard]] std::size_t take_further_goals();

  [[nodiscard]] std::uint64_t iterations() const { return result_.iterations; }
  /// Counts and returns `most` iterations, or the number that the limit leaves: 0 once a limit is
  /// reached or the run is cancelled.
  int begin_iterations(int most = 1);
  /// True once the time is up, the run is cancelled or the limit of nodes is reached. Cheap enough
  /// for inner loops.
  [[nodiscard]] bool must_stop();
  /// Counts nodes that trees or the roadmap gain, or lose, against the limit.
  void count_nodes(int gained) { node_count_ += gained; }
  /// Samples without showing the sample to the observer, because the caller may replace it.
  SampleSource next_sample(std::span<float> q) { return stream_->next(q); }
  SampleSource sample(std::span<float> q) {
    const SampleSource source = next_sample(q);
    checker_.project(q);
    show_sample(q, source);
    return source;
  }
  void show_sample(std::span<const float> q, SampleSource source) const {
    if (settings_.observer != nullptr) settings_.observer->on_sample(q, source);
  }
  /// Shows the observer, if any, an edge of tree or roadmap number `graph`.
  void show_edge(std::span<const float> from, std::span<const float> to, int graph) const {
    if (settings_.observer != nullptr) settings_.observer->on_edge(from, to, graph);
  }
  void report(SampleSource source, SampleOutcome outcome) { stream_->report(source, outcome); }
  [[nodiscard]] bool is_motion_valid(std::span<const float> from, std::span<const float> to) {
    const MotionDetail detail{.refinement = is_early() ? kEarlyRefinement : 1};
    return checker_.is_motion_valid(from, to, counters_, detail) &&
           (!shorten_and_verify_.has_refused_often() || would_pass(from, to));
  }
  [[nodiscard]] const CollisionChecker& checker() const { return checker_; }
  [[nodiscard]] std::uint64_t states_checked() const { return counters_.states; }
  /// Counts what others have checked for this run.
  void count(const CheckCounters& counters) {
    counters_.states += counters.states;
    counters_.work += counters.work;
  }
  /// Remembered motions; may be null.
  [[nodiscard]] MotionSource* motions() const { return motions_; }
  /// Work done so far, in the unit of CheckCounters::work.
  [[nodiscard]] std::uint64_t work() const {
    return counters_.work + kIterationWork * result_.iterations;
  }
  void walk(std::span<const float> from, const WalkStep& step, std::span<float> candidates) {
    checker_.walk(from, step, candidates, counters_);
  }
  void check_states(std::span<const float> configurations, std::span<std::uint8_t> is_valid) {
    checker_.check_states(configurations, is_valid, counters_);
  }
  /// True if a straight motion from the start to a goal passes: call finish() then.
  [[nodiscard]] bool find_direct_path();

  /// Offers a path from the start to a goal. Returns -1 if it passes, and keeps it for finish();
  /// otherwise the index of the first motion that fails.
  [[nodiscard]] int find_invalid_motion(const FloatPath& path);

  /// Ends the run with the path that passed last.
  [[nodiscard]] PlanResult finish(int node_count);
  /// Ends the run without a path.
  [[nodiscard]] PlanResult give_up(int node_count);

 private:
  /// Work of an iteration: a sample and the search for its nearest node.
  static constexpr std::uint64_t kIterationWork = 2000;
  /// Number of early iterations. Their steps are long and checked at kEarlyRefinement of the
  /// resolution, so that a step still takes one vector of states.
  static constexpr std::uint64_t kEarly = 100;
  static constexpr float kEarlyRefinement = 0.5f;
  /// Number of iterations after which a search is long. Ordinary problems take fewer.
  static constexpr std::uint64_t kLongSearch = 300'000;
  /// Iterations between two calls for further goals, each of which costs about ten iterations.
  static constexpr std::uint64_t kGoalPeriod = 1000;
  static constexpr std::size_t kMostGoals = 64;

  [[nodiscard]] bool would_pass(std::span<const float> from, std::span<const float> to);
  /// Replaces the ends by the query's start and goal, which are not rounded to single precision.
  [[nodiscard]] Path to_query_path(const FloatPath& path) const;
  void refuse(PlanStatus status, std::string message);
  /// Refuses, and must_stop() from now on.
  void stop(PlanStatus status, std::string message);
  void add_goal(const Configuration& goal);
  [[nodiscard]] PlanResult take_result(int node_count);

  Stopwatch stopwatch_;
  const CollisionChecker& checker_;
  const PlanQuery& query_;
  PathFinisher& shorten_and_verify_;
  const PlanSettings& settings_;
  JointSpace space_;
  float range_;
  float long_range_;
  std::uint64_t early_iterations_;
  float first_domain_;
  std::vector<float> start_;
  std::vector<Configuration> goal_configurations_;  ///< goals_ before rounding
  FloatPath goals_;
  GoalSource* further_goals_;
  std::uint64_t next_goals_ = kGoalPeriod;  ///< in iterations
  std::uint64_t work_per_clock_check_;
  std::unique_ptr<SampleStream> stream_;
  SearchLimit* limit_;
  MotionSource* motions_;
  CheckCounters counters_;
  PlanResult result_;
  bool is_stopped_ = false;
  std::int64_t node_count_ = 0;
  std::uint64_t next_clock_check_ = 0;  ///< in iterations and motions
};

/// Tries the straight motion, then `Algorithm(run).solve()`.
template <class Algorithm>
[[nodiscard]] PlanResult run_planner(const PlanTask& task) {
  PlannerRun run(task);
  if (run.find_direct_path()) return run.finish(2);
  return Algorithm(run).solve();
}

}  // namespace mneme::internal
