// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Section IV-A of the paper. One departure makes learning cheap: queries go from shallow to deep,
// and each one samples with Algorithm 1 from what the shallower ones have taught.
#include "memory/local_queries.h"

#include "memory/merge_cliques.h"

#include <algorithm>

namespace mneme::internal {
namespace {

constexpr int kFreeAttempts = 100;
constexpr int kGoalsPerQuery = 4;
constexpr double kBootstrapLambda = 0.5;
constexpr double kBootstrapSigma = 0.1;

class Learner {
 public:
  Learner(const CollisionChecker& checker, const QuerySource& source, const LearnSettings& settings,
          std::uint64_t seed, double deadline_s, const std::atomic<bool>* cancel)
      : checker_(checker),
        source_(source),
        settings_(settings),
        rng_(seed),
        deadline_s_(deadline_s),
        cancel_(cancel),
        uniform_(make_uniform_sampler(checker.robot())) {
    result_.sampler.joint_count = checker.robot().joint_count();
  }

  LearnResult run() {
    for (int depth = 0; depth < source_.depth_count() && !is_late(); ++depth) learn_at(depth);
    if (settings_.merge_cliques && result_.sampler.component_count() > 0) {
      result_.sampler = merge_cliques(checker_, result_.sampler, [this] { return is_late(); });
    }
    result_.time_s = stopwatch_.elapsed_s();
    return std::move(result_);
  }

 private:
  [[nodiscard]] bool is_late() const {
    if (cancel_ != nullptr && cancel_->load()) return true;
    return deadline_s_ > 0 && stopwatch_.elapsed_s() >= deadline_s_;
  }

  void learn_at(int depth) {
    const std::shared_ptr<const Sampler> sampler = make_sampler();
    for (int i = 0; i < settings_.starts_per_link && !is_late(); ++i) {
      const auto start = source_.draw_start(depth, starts_, rng_);
      if (!start) return;
      starts_.push_back(*start);
      PlanQuery query{*start, free_configurations()};
      if (query.goals.empty()) return;
      for (int j = 0; j < settings_.paths_per_start && !is_late(); ++j) {
        if (!learn_from_query(query, *sampler)) break;
      }
    }
  }

  /// Algorithm 1 over what was learned so far.
  std::shared_ptr<const Sampler> make_sampler() {
    if (result_.sampler.component_count() == 0) return uniform_;
    auto so_far = std::make_shared<const GaussianMixture>(result_.sampler);
    return make_mixed_sampler(kBootstrapLambda,
                              make_mixture_sampler(checker_.robot(), so_far, kBootstrapSigma),
                              uniform_);
  }

  std::vector<Configuration> free_configurations() {
    std::vector<Configuration> found;
    for (int i = 0; i < kFreeAttempts && static_cast<int>(found.size()) < kGoalsPerQuery; ++i) {
      Configuration q;
      for (int j = 0; j < checker_.robot().joint_count(); ++j) {
        const Joint& joint = checker_.robot().group_joint(j);
        q.push_back(rng_.uniform(joint.lower, joint.upper));
      }
      if (source_.is_clear(q) && checker_.is_valid(std::span<const double>(q))) {
        found.push_back(std::move(q));
      }
    }
    return found;
  }

  bool learn_from_query(const PlanQuery& query, const Sampler& sampler) {
    PlanSettings plan;
    plan.range = settings_.range;
    plan.max_iterations = static_cast<std::uint64_t>(settings_.max_iterations);
    plan.timeout_s = deadline_s_ > 0 ? std::max(0.0, deadline_s_ - stopwatch_.elapsed_s()) : 1e6;
    plan.seed = rng_.next();
    plan.verify = false;
    plan.cancel = cancel_;
    const PlanResult planned = plan_with(rrt_connect, checker_, query, sampler, plan);
    ++result_.queries;
    result_.iterations += planned.iterations;
    if (!planned.is_solved()) return false;
    ++result_.solved;
    // The last waypoint is an arbitrary configuration outside; it says nothing about the gap.
    for (std::size_t i = 0; i + 1 < planned.path.size(); ++i) add_component(planned.path[i]);
    return true;
  }

  /// Not if it is in contact once it is rounded as it is stored.
  void add_component(const Configuration& q) {
    const std::vector<float> mean(q.begin(), q.end());
    if (!checker_.is_valid(std::span<const float>(mean))) return;
    result_.sampler.means.insert(result_.sampler.means.end(), mean.begin(), mean.end());
  }

  Stopwatch stopwatch_;
  const CollisionChecker& checker_;
  const QuerySource& source_;
  const LearnSettings& settings_;
  Rng rng_;
  double deadline_s_;
  const std::atomic<bool>* cancel_;
  std::shared_ptr<const Sampler> uniform_;
  std::vector<Configuration> starts_;
  LearnResult result_;
};

}  // namespace

LearnResult learn_from_queries(const CollisionChecker& checker, const QuerySource& source,
                               const LearnSettings& settings, std::uint64_t seed, double deadline_s,
                               const std::atomic<bool>* cancel) {
  return Learner(checker, source, settings, seed, deadline_s, cancel).run();
}

}  // namespace mneme::internal
