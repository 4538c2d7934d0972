// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What all planners do around their algorithm: validation, limits, verification, simplification.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mneme/planning.h"
#include "base/stopwatch.h"
#include "path/verify.h"
#include "robot/joint_space.h"

namespace mneme::internal {

using FloatPath = std::vector<std::vector<float>>;

/// One call of a planner. Not thread-safe.
class PlannerRun {
 public:
  /// Validates start and goals; check is_ready() before planning.
  PlannerRun(const CollisionChecker& checker, const PlanQuery& query, const Sampler& sampler,
             const PlanSettings& settings);
  PlannerRun(const PlannerRun&) = delete;
  PlannerRun& operator=(const PlannerRun&) = delete;

  [[nodiscard]] bool is_ready() const { return is_ready_; }
  [[nodiscard]] const JointSpace& space() const { return space_; }
  /// Length of a step; shorter in a long search unless the settings name it.
  [[nodiscard]] float range() const { return is_long_search() ? long_range_ : range_; }
  /// Squared radius of a tree node's domain once it could not be extended; infinite for planar
  /// arms, whose passages are found sooner without.
  [[nodiscard]] float first_domain() const { return first_domain_; }
  /// True once an arm in space has searched for so long that its passage must be narrow: domains no
  /// longer count then, because what they keep out may be the way.
  [[nodiscard]] bool is_long_search() const {
    return result_.iterations > kLongSearch && std::isfinite(first_domain_);
  }
  [[nodiscard]] const PlanSettings& settings() const { return settings_; }
  [[nodiscard]] Isa isa() const { return checker_.isa(); }
  [[nodiscard]] const std::vector<float>& start() const { return start_; }
  [[nodiscard]] const FloatPath& goals() const { return goals_; }

  /// Counts iterations, `most` or what the limit leaves of them, and returns how many: 0 once a
  /// limit is reached or the run is cancelled.
  int begin_iterations(int most = 1);
  /// True once the time is up, the run is cancelled or there are as many nodes as may be. Cheap:
  /// for the loops within an iteration too.
  [[nodiscard]] bool must_stop();
  /// Counts nodes that trees or the roadmap gain, or lose: how many there may be is limited.
  void count_nodes(int gained) { node_count_ += gained; }
  Origin sample(std::span<float> q) {
    const Origin origin = stream_->next(q);
    if (settings_.observer != nullptr) settings_.observer->on_sample(q, origin);
    return origin;
  }
  /// Tells the observer, if there is one, about an edge of tree or roadmap number `graph`.
  void show_edge(std::span<const float> from, std::span<const float> to, int graph) const {
    if (settings_.observer != nullptr) settings_.observer->on_edge(from, to, graph);
  }
  void report(Origin origin, SampleOutcome outcome) { stream_->report(origin, outcome); }
  [[nodiscard]] bool is_motion_valid(std::span<const float> from, std::span<const float> to) {
    return checker_.is_motion_valid(from, to, counters_);
  }
  void check_states(std::span<const float> configurations, std::span<std::uint8_t> is_valid) {
    counters_.states += is_valid.size();
    checker_.check_states(configurations, is_valid);
  }
  /// The goal that a straight motion from the start reaches, or -1.
  [[nodiscard]] int find_direct_goal();

  /// The first motion of `path` that fails verification, or -1; its time is not planning time. What
  /// shortcuts at the planner's resolution leave of a path nearly always passes and has less to
  /// verify: so it is looked at first, and is then what finish() returns.
  [[nodiscard]] int find_invalid_motion(const FloatPath& path);

  /// Ends the run with a path from the start to goal number `goal`, which was verified before.
  [[nodiscard]] PlanResult finish(const FloatPath& path, int goal, int node_count);
  /// Ends the run without a path.
  [[nodiscard]] PlanResult give_up(int node_count);

 private:
  /// Iterations. Ordinary problems take fewer.
  static constexpr std::uint64_t kLongSearch = 300'000;

  void validate();
  [[nodiscard]] bool is_cancelled() const;
  [[nodiscard]] bool is_time_up() const;
  [[nodiscard]] bool is_full() const;
  [[nodiscard]] int find_invalid_motion(const Path& path);
  /// With the query's own start and goal at its ends, not rounded to single precision.
  [[nodiscard]] Path to_query_path(const FloatPath& path, std::size_t goal) const;
  /// Made when it is first wanted.
  [[nodiscard]] const MotionVerifier& verifier();
  /// Each shortcut passes `verifier`, unless that is null.
  [[nodiscard]] Path shortened(Path path, const MotionVerifier* verifier);
  void refuse(PlanStatus status, std::string message);
  [[nodiscard]] PlanResult take_result(int node_count);

  Stopwatch stopwatch_;
  const CollisionChecker& checker_;
  const PlanQuery& query_;
  const PlanSettings& settings_;
  JointSpace space_;
  float range_;
  float long_range_;
  float first_domain_;
  std::vector<float> start_;
  FloatPath goals_;
  std::uint64_t work_per_clock_check_;
  std::unique_ptr<SampleStream> stream_;
  std::optional<MotionVerifier> verifier_;
  std::optional<Path> shortened_;  ///< and verified
  CheckCounters counters_;
  PlanResult result_;
  bool is_ready_ = false;
  bool is_stopped_ = false;
  std::int64_t node_count_ = 0;
  int refused_path_count_ = 0;
  std::uint64_t next_clock_check_ = 0;  ///< in iterations and motions
};

}  // namespace mneme::internal
