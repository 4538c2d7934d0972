// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/improve.h"

#include "base/threads.h"
#include "planning/informed_box.h"

#include <algorithm>
#include <utility>

namespace mneme::internal {
namespace {

/// Rough plans per round; the shortest is shortened. The side on which a path passes obstacles
/// matters more than further shortening, and a rough path shows it.
constexpr int kPlansPerRound = 3, kPlansPerTimedRound = 2;
constexpr int kPatience = 160;      ///< for length; for time, other plans pay more than patience
constexpr double kRounding = 1e-6;  ///< relative, of single precision
/// Paths that take longer than this multiple of the straight motion are too far from it for samples
/// in a box around it to help.
constexpr double kNearStraight = 2;
/// Whatever time there is to improve, a path of a trajectory gets this number of rounds. They plan
/// until about this number of states is checked: some half a millisecond. Each of their plans ends
/// after so many more iterations than the first plan took: there may be no path among its samples.
constexpr std::uint64_t kFreeRounds = 3, kFreeStates = 40000, kFreeIterations = 1000;

bool has_free_rounds(const PlanSettings& plan) {
  return plan.simplify && plan.minimizes_time() && plan.limits != nullptr;
}

class Improvement {
 public:
  Improvement(const ResolvedQuery& resolved, const Sampler& sampler, SolveResult& result)
      : resolved_(resolved),
        query_(resolved.query),
        sampler_(sampler),
        verifier_(resolved.checker),
        best_(result.plan),
        curve_(result.improvements),
        first_iterations_(result.plan.iterations),
        cost_(cost_of(result.plan.path, &verifier_)) {
    note(0);
    const auto straight_to = [&](const Configuration& goal) {
      return cost_of({resolved.ends.start, goal}) * (1 + kRounding);
    };
    // The goal reached may have been found while planning.
    least_cost_ = straight_to(result.plan.path.back());
    for (const Configuration& goal : resolved.ends.goals) {
      if (is_time_over()) break;
      least_cost_ = std::min(least_cost_, straight_to(goal));
    }
  }

  void run() {
    const std::uint64_t rounds = query_.settings.plan.improve_rounds.value_or(~std::uint64_t{0});
    for (round_ = 0; round_ < rounds && !is_over(); ++round_) {
      Path path = round_ == 0 ? best_.path : plan_again();
      if (!path.empty()) offer(std::move(path));
    }
  }

 private:
  /// Seconds or length. With a verifier, corners are only as fast as they are free.
  [[nodiscard]] double cost_of(const Path& path, const MotionVerifier* verifier = nullptr) const {
    const Robot& robot = query_.problem.robot;
    const PlanSettings& plan = query_.settings.plan;
    if (!plan.minimizes_time()) return path_length(robot, path);
    return plan.limits != nullptr ? estimate_duration(robot, path, *plan.limits, verifier)
                                  : path_time(robot, path);
  }
  void note(double time_s) {
    const bool is_asked = query_.settings.plan.improve > 0;
    if (is_asked) curve_.push_back({time_s, path_length(query_.problem.robot, best_.path)});
  }
  [[nodiscard]] bool is_free_round() const {
    return has_free_rounds(query_.settings.plan) && round_ < kFreeRounds;
  }
  [[nodiscard]] double remaining_s() const {
    return is_free_round() ? query_.remaining_s()
                           : query_.settings.plan.improve - stopwatch_.elapsed_s();
  }
  [[nodiscard]] bool is_time_over() const {
    return remaining_s() <= verification_time_s_ || is_set(query_.settings.plan.cancel);
  }
  /// True also if no path can be shorter.
  [[nodiscard]] bool is_over() const { return is_time_over() || cost_ <= least_cost_; }
  /// True also if another plan would check too many states. Planning again costs about as much as
  /// planning.
  [[nodiscard]] bool is_plan_too_much() const {
    const bool is_time_over = query_.settings.plan.improve <= stopwatch_.elapsed_s();
    return is_over() || (is_time_over && best_.states_checked > kFreeStates);
  }
  [[nodiscard]] PlanSettings settings_of(std::uint64_t task) const {
    PlanSettings settings = query_.settings.plan;
    settings.seed = derive_seed(query_.settings.plan.seed, kFirstTask + task);
    settings.timeout_s = std::max(0.0, remaining_s());
    settings.observer = nullptr;
    if (is_free_round()) {
      const std::uint64_t most = first_iterations_ + kFreeIterations;
      settings.max_iterations = std::min(settings.max_iterations.value_or(most), most);
    }
    return settings;
  }

  /// Null where samples of the query's sampler are better.
  [[nodiscard]] std::unique_ptr<Sampler> informed_sampler() const {
    const PlanSettings& plan = query_.settings.plan;
    const bool is_near = cost_ < kNearStraight * least_cost_;
    if (!plan.minimizes_time() || plan.limits == nullptr || !is_near) return nullptr;
    return make_informed_sampler(query_.problem.robot, resolved_.ends, *plan.limits, cost_,
                                 [this] { return is_time_over(); });
  }

  /// Returns the shortest of a few rough paths; empty if none is found in time.
  Path plan_again() {
    Path shortest;
    double least = 0;
    const std::unique_ptr<Sampler> informed = informed_sampler();
    const Sampler& sampler = informed != nullptr ? *informed : sampler_;
    const bool is_timed = query_.settings.plan.minimizes_time();
    const int plans = is_timed ? kPlansPerTimedRound : kPlansPerRound;
    for (int i = 0; i < plans && !is_plan_too_much(); ++i) {
      PlanSettings settings = settings_of(round_ * kPlansPerRound + static_cast<std::uint64_t>(i));
      settings.verify = false;
      settings.simplify = true;
      settings.patience = 0;
      if (informed != nullptr) settings.anchor = 0;  // these samples would leave the box
      PathFinisher finisher(resolved_.checker, settings.finish());
      const auto valid_states = query_.sampler.samples_valid_states ? query_.sampler.name : "";
      auto planned = query_.planner.plan(
          {resolved_.checker, resolved_.ends, sampler, settings, finisher, valid_states});
      if (!planned) continue;
      best_.iterations += planned->iterations;
      count({planned->states_checked, planned->motions_checked});
      if (!planned->is_solved()) continue;
      const double cost = cost_of(planned->path);
      if (!shortest.empty() && cost >= least) continue;
      shortest = std::move(planned->path);
      least = cost;
    }
    return shortest;
  }

  /// Shortens the path, and takes it if it is then the shortest one that passes. The first path was
  /// shortened in time already: shortening it in length gives another place to begin.
  void offer(Path path) {
    CheckCounters counters;
    const bool is_timed = query_.settings.plan.minimizes_time();
    if (is_timed && round_ == 0) shorten_in(false, path, counters);
    shorten_in(is_timed, path, counters);
    if (cost_of(path) < cost_) verify(std::move(path), counters);
    count(counters);
  }

  /// In time or in length.
  void shorten_in(bool time, Path& path, CheckCounters& counters) {
    const PlanSettings settings = settings_of(round_ * kPlansPerRound);
    ShortenEffort effort;
    effort.minimize_time = time;
    effort.patience = std::max(settings.minimizes_time() ? 0 : kPatience, settings.patience);
    effort.limits = settings.limits.get();
    shorten(resolved_.checker, path, settings.seed, effort, nullptr, counters,
            [&] { return is_over(); });
  }

  void verify(Path path, CheckCounters& counters) {
    FinishSettings settings = query_.settings.plan.finish();
    settings.simplify = false;
    PathFinisher finisher(resolved_.checker, settings);
    const int invalid = finisher(path, counters);
    verification_time_s_ = std::max(verification_time_s_, finisher.verification_time_s());
    if (invalid >= 0) return;
    const double cost = cost_of(path, &verifier_);
    if (cost >= cost_) return;
    best_.path = std::move(path);
    cost_ = cost;
    note(stopwatch_.elapsed_s());
  }

  void count(const CheckCounters& counters) {
    best_.states_checked += counters.states;
    best_.motions_checked += counters.motions;
  }

  /// Seeds; planners derive theirs from smaller numbers.
  static constexpr std::uint64_t kFirstTask = 1000;

  const ResolvedQuery& resolved_;
  const Query& query_;
  const Sampler& sampler_;
  MotionVerifier verifier_;
  std::uint64_t round_ = 0;
  PlanResult& best_;
  std::vector<Improved>& curve_;
  std::uint64_t first_iterations_;
  double cost_;                     ///< of the best path: seconds or length
  double least_cost_ = 0;           ///< lower bound for any path
  double verification_time_s_ = 0;  ///< longest verification so far; this time is reserved for the
                                    ///< next one
  Stopwatch stopwatch_;
};

}  // namespace

void improve(const ResolvedQuery& resolved, const Sampler& sampler, SolveResult& result) {
  const PlanSettings& plan = resolved.query.settings.plan;
  if (!(plan.improve > 0) && !has_free_rounds(plan)) return;
  if (!result.plan.is_solved()) return;
  const Stopwatch stopwatch;
  Improvement(resolved, sampler, result).run();
  result.improvement_time_s = stopwatch.elapsed_s();
}

}  // namespace mneme::internal
