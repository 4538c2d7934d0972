// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/improve.h"

#include <utility>

namespace mneme::internal {
namespace {

/// Of so many plans the shortest is shortened: which way round obstacles a path goes decides more
/// than how long it is shortened, and a rough path tells it.
constexpr int kPlansPerRound = 4;
constexpr int kRoughPatience = 4;
constexpr int kPatience = 80;

class Improvement {
 public:
  Improvement(const Query& query, const Sampler& sampler, SolveResult& result)
      : query_(query),
        sampler_(sampler),
        best_(result.plan),
        curve_(result.improvements),
        length_(path_length(query.problem.robot, result.plan.path)) {}

  void run() {
    const std::uint64_t rounds = query_.settings.plan.improve_rounds.value_or(~std::uint64_t{0});
    for (std::uint64_t round = 0; round < rounds && !is_over(); ++round) {
      Path path = round == 0 ? best_.path : plan_again(round);
      if (!path.empty()) offer(std::move(path), round);
    }
  }

 private:
  [[nodiscard]] double remaining_s() const {
    return query_.settings.plan.improve - stopwatch_.elapsed_s();
  }
  [[nodiscard]] bool is_over() const {
    const std::atomic<bool>* cancel = query_.settings.plan.cancel;
    return remaining_s() <= 0 || (cancel != nullptr && cancel->load(std::memory_order_relaxed));
  }
  [[nodiscard]] PlanSettings settings_of(std::uint64_t task) const {
    PlanSettings settings = query_.settings.plan;
    settings.seed = derive_seed(query_.settings.plan.seed, kFirstTask + task);
    settings.timeout_s = std::max(0.0, remaining_s());
    settings.observer = nullptr;
    return settings;
  }

  /// The shortest of a few rough paths; empty if none is found in time.
  Path plan_again(std::uint64_t round) {
    Path shortest;
    double least = 0;
    for (int i = 0; i < kPlansPerRound && !is_over(); ++i) {
      PlanSettings settings = settings_of(round * kPlansPerRound + static_cast<std::uint64_t>(i));
      settings.verify = false;
      settings.simplify = true;
      settings.patience = kRoughPatience;
      PathFinisher finisher(query_.checker, settings.finish());
      const auto valid_states = query_.sampler.draws_valid_states ? query_.sampler.name : "";
      auto planned = query_.planner.plan(
          {query_.checker, query_.ends, sampler_, settings, finisher, valid_states});
      if (!planned || !planned->is_solved()) continue;
      count(*planned);
      const double length = path_length(query_.problem.robot, planned->path);
      if (!shortest.empty() && length >= least) continue;
      shortest = std::move(planned->path);
      least = length;
    }
    return shortest;
  }

  /// Takes the path if it is shorter than the best one once it is shortened, and passes.
  void offer(Path path, std::uint64_t round) {
    PlanSettings settings = settings_of(round * kPlansPerRound);
    settings.simplify = true;
    settings.patience = std::max(kPatience, settings.patience);
    PathFinisher finisher(query_.checker, settings.finish());
    CheckCounters counters;
    const int invalid = finisher(path, counters);
    best_.states_checked += counters.states;
    best_.motions_checked += counters.motions;
    const double length = path_length(query_.problem.robot, path);
    if (invalid >= 0 || length >= length_) return;
    best_.path = std::move(path);
    length_ = length;
    curve_.push_back({stopwatch_.elapsed_s(), length});
  }

  void count(const PlanResult& planned) {
    best_.iterations += planned.iterations;
    best_.states_checked += planned.states_checked;
    best_.motions_checked += planned.motions_checked;
  }

  /// Of seeds: what planners derive from theirs comes before.
  static constexpr std::uint64_t kFirstTask = 1000;

  const Query& query_;
  const Sampler& sampler_;
  PlanResult& best_;
  std::vector<Improved>& curve_;
  double length_;
  Stopwatch stopwatch_;
};

}  // namespace

void improve(const Query& query, const Sampler& sampler, SolveResult& result) {
  if (!(query.settings.plan.improve > 0) || !result.plan.is_solved()) return;
  const Stopwatch stopwatch;
  Improvement(query, sampler, result).run();
  result.improvement_time_s = stopwatch.elapsed_s();
}

}  // namespace mneme::internal
