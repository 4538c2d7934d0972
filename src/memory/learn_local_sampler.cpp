// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Section IV-A of the paper, with one departure that makes learning cheap: queries go from shallow
// to deep, and each samples with Algorithm 1 from the components learned so far.
#include "mneme/memory.h"

#include "memory/planar_chain.h"
#include "store/row_check.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace mneme {
namespace {

constexpr int kStartAttempts = 300;
constexpr int kFreeAttempts = 100;
constexpr int kGoalsPerQuery = 4;

/// Learns one pair of circles for a planar arm.
class Learner {
 public:
  Learner(const CollisionChecker& checker, const internal::PlanarChain& chain,
          const PrimitiveKey& key, const LearnSettings& settings, std::uint64_t seed,
          double deadline_s, const std::atomic<bool>* cancel)
      : checker_(checker),
        chain_(chain),
        key_(key),
        settings_(settings),
        rng_(seed),
        deadline_s_(deadline_s),
        cancel_(cancel),
        uniform_(make_uniform_sampler(checker.robot())) {
    result_.sampler.joint_count = checker.robot().joint_count();
  }

  /// Starts with the shallowest queries, where only the last link crosses the gap.
  LearnResult run() {
    for (int link = chain_.link_count() - 1; link >= 0 && !is_late(); --link) learn_from(link);
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

  /// Solves queries that start with `link` as the first one through the gap.
  void learn_from(int link) {
    const std::shared_ptr<const Sampler> sampler = make_sampler();
    for (int i = 0; i < settings_.starts_per_link && !is_late(); ++i) {
      const auto start =
          internal::sample_threaded(checker_, chain_, key_, link, kStartAttempts, rng_);
      if (!start) return;
      const PlanQuery query{*start, internal::sample_outside(checker_, chain_, key_, kGoalsPerQuery,
                                                             kFreeAttempts, rng_)};
      if (query.goals.empty()) return;
      for (int j = 0; j < settings_.paths_per_start && !is_late(); ++j) {
        if (!learn_from_query(query, *sampler)) break;
      }
    }
  }

  /// Algorithm 1 over the components learned so far.
  std::shared_ptr<const Sampler> make_sampler() {
    if (result_.sampler.component_count() == 0) return uniform_;
    auto so_far = std::make_shared<const GaussianMixture>(result_.sampler);
    return make_mixed_sampler(
        internal::kBootstrapLambda,
        make_mixture_sampler(checker_.robot(), so_far, internal::kBootstrapSigma), uniform_);
  }

  bool learn_from_query(const PlanQuery& query, const Sampler& sampler) {
    PlanSettings plan;
    plan.range = settings_.range;
    plan.max_iterations = static_cast<std::uint64_t>(settings_.max_iterations);
    plan.timeout_s = deadline_s_ > 0 ? std::max(0.0, deadline_s_ - stopwatch_.elapsed_s()) : 1e6;
    plan.seed = rng_.next();
    plan.verify = false;
    plan.cancel = cancel_;
    if (!settings_.walks.value_or(true)) plan.anchor = plan.walk = 0.0;
    const PlanResult planned = plan_with(rrt_connect, checker_, query, sampler, plan);
    ++result_.queries;
    result_.iterations += planned.iterations;
    if (!planned.is_solved()) return false;
    ++result_.solved;
    // The last waypoint is an arbitrary configuration outside; it says nothing about the gap.
    for (std::size_t i = 0; i + 1 < planned.path.size(); ++i) add_component(planned.path[i]);
    return true;
  }

  /// Skips a configuration that is in contact once it is rounded for storage.
  void add_component(const Configuration& q) {
    const std::vector<float> mean(q.begin(), q.end());
    if (!checker_.is_valid(std::span<const float>(mean))) return;
    result_.sampler.means.insert(result_.sampler.means.end(), mean.begin(), mean.end());
  }

  Stopwatch stopwatch_;
  const CollisionChecker& checker_;
  const internal::PlanarChain& chain_;
  const PrimitiveKey& key_;
  const LearnSettings& settings_;
  Rng rng_;
  double deadline_s_;
  const std::atomic<bool>* cancel_;
  std::shared_ptr<const Sampler> uniform_;
  LearnResult result_;
};

/// Rejects keys of other kinds, which would be misread as circles.
Result<void> check_circles(const PrimitiveKey& key) {
  // Written so that a NaN is no length.
  const auto is_length = [](double value) { return std::abs(value) <= internal::kMaxKeyMagnitude; };
  if (key.size() == kCirclePairKeySize && std::ranges::all_of(key, is_length)) return {};
  return fail(ErrorCode::invalid,
              fmt::format("a primitive of a planar arm cannot be learned: its key is ({:.4g}); "
                          "expected the 6 numbers of a pair of circles, metres, at most {}",
                          fmt::join(key, ", "), internal::kMaxKeyMagnitude));
}

}  // namespace

std::string describe(const LearnSettings& settings) {
  std::string text;
  visit_settings(settings, [&](const char* name, const auto& value, auto, auto, const char*) {
    text += fmt::format("{}{}=", text.empty() ? "" : " ", name);
    if constexpr (SettingTraits<std::remove_cvref_t<decltype(value)>>::kIsOptional) {
      text += value ? fmt::format("{}", *value) : "default";
    } else {
      text += fmt::format("{}", value);
    }
  });
  return text;
}

Result<LearnResult> learn_local_sampler(const Robot& robot, const PrimitiveKey& key,
                                        const LearnSettings& settings, std::uint64_t seed,
                                        double deadline_s, const std::atomic<bool>* cancel) {
  const auto chain = MNEME_TRY(internal::PlanarChain::make(robot));
  MNEME_TRY(check_circles(key));
  const auto checker = MNEME_TRY(
      CollisionChecker::make(robot, make_scene(key), {.resolution = settings.resolution}));
  return Learner(checker, chain, key, settings, seed, deadline_s, cancel).run();
}

}  // namespace mneme
