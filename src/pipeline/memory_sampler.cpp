// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/memory_sampler.h"

#include <algorithm>
#include <utility>

namespace mneme::internal {

std::shared_ptr<const Sampler> MemorySampler::by_kind() {
  std::vector<Source> sources;
  for (const KindSettings& kind : query().kinds) {
    sources.push_back(
        {kind.lambda, kind.least_lambda, kind.retrieve_after, [this, &kind] {
           return recall_(query(), memory_query_, kind, gl_).map([&](Recalled recalled) {
             return sample(kind, std::move(recalled));
           });
         }});
  }
  return from_sources(std::move(sources));
}

std::shared_ptr<const Sampler> MemorySampler::from_mixture(
    std::function<Result<GaussianMixture>()> recall) {
  return from_sampler([this, recall = std::move(recall)]() {
    return recall().map(
        [&](GaussianMixture mixture) { return sample(query().kinds.front(), std::move(mixture)); });
  });
}

std::shared_ptr<const Sampler> MemorySampler::from_sampler(
    std::function<Result<std::shared_ptr<const Sampler>>()> make) {
  if (query().kinds.empty()) return from_sources({});
  const KindSettings& kind = query().kinds.front();
  return from_sources(
      {{kind.lambda, kind.least_lambda, kind.retrieve_after, [this, make = std::move(make)] {
          const Stopwatch stopwatch;
          auto made = make();
          gl_.retrieval_time_s = stopwatch.elapsed_s();
          return made;
        }}});
}

std::shared_ptr<const Sampler> MemorySampler::from_sources(std::vector<Source> sources) {
  sources_ = std::move(sources);
  std::ranges::stable_sort(sources_, {}, &Source::after);
  retrieve_after_ = sources_.empty() ? 0 : sources_.front().after;
  if (timing_ == Timing::at_once) {
    for (Source& source : sources_) source.after = 0;
  }
  return sampler_after(0);
}

std::shared_ptr<const Sampler> MemorySampler::sampler_after(int samples) {
  const std::lock_guard lock(mutex_);
  const auto known = std::ranges::find(stages_, samples, [](const auto& s) { return s.first; });
  if (known != stages_.end()) return known->second;
  while (queried_sources_ < sources_.size() && sources_[queried_sources_].after <= samples)
    query_source(sources_[queried_sources_++]);
  std::shared_ptr<const Sampler> sampler = mixed();
  if (queried_sources_ < sources_.size()) {
    const int next = sources_[queried_sources_].after;
    sampler = make_lazy_sampler(std::move(sampler), next - samples,
                                [this, next] { return sampler_after(next); });
  }
  stages_.emplace_back(samples, sampler);
  return sampler;
}

/// Several sources share lambda, so that uniform samples keep their share.
std::shared_ptr<const Sampler> MemorySampler::mixed() const {
  std::shared_ptr<const Sampler> uniform = make_uniform_sampler(query().problem.robot);
  if (samplers_.empty()) return uniform;
  std::vector<MixedSource> shares = samplers_;
  for (MixedSource& share : shares) {
    share.lambda /= static_cast<double>(shares.size());
    share.least_lambda /= static_cast<double>(shares.size());
  }
  return make_mixed_sampler(std::move(shares), std::move(uniform));
}

void MemorySampler::query_source(const Source& source) {
  marks_.push_back({source.after, gl_.primitives.size(), components_.size(), gl_.mixture});
  auto sampler = source.make();
  if (!sampler) {
    marks_.back().failure = sampler.error();
  } else if (*sampler != nullptr) {
    samplers_.push_back({*std::move(sampler), source.lambda, source.least_lambda});
  }
}

Result<std::shared_ptr<const Sampler>> MemorySampler::make() {
  const Stopwatch stopwatch;
  auto sampler = query().sampler.make(*this);
  time_s_ = stopwatch.elapsed_s();
  MNEME_TRY(check());
  return sampler;
}

Result<void> MemorySampler::check(std::uint64_t samples) const {
  const auto failed = std::ranges::find_if(
      marks_, [&](const Mark& mark) { return mark.failure && mark.is_within(samples); });
  if (failed != marks_.end()) return tl::unexpected(*failed->failure);
  return {};
}

GlSampler MemorySampler::take(std::uint64_t samples) {
  const auto too_late =
      std::ranges::find_if(marks_, [&](const Mark& mark) { return !mark.is_within(samples); });
  if (too_late != marks_.end()) {
    gl_.primitives.erase(gl_.primitives.begin() + static_cast<std::ptrdiff_t>(too_late->primitives),
                         gl_.primitives.end());
    components_.resize(too_late->components);
    gl_.mixture = too_late->mixture;
  }
  for (const auto& components : components_) add_to_found(components->made());
  return std::move(gl_);
}

void MemorySampler::add_to_found(const GaussianMixture& mixture) {
  GaussianMixture all = gl_.mixture == nullptr ? GaussianMixture{} : *gl_.mixture;
  append(all, mixture);
  gl_.mixture = std::make_shared<const GaussianMixture>(std::move(all));
}

std::shared_ptr<const Sampler> MemorySampler::sample(const KindSettings& kind, Recalled recalled) {
  if (auto* mixture = std::get_if<GaussianMixture>(&recalled)) {
    return sample_mixture(kind, std::move(*mixture));
  }
  const Robot& robot = query().problem.robot;
  std::optional<CollisionChecker> checker;
  if (kind.drop_invalid_means) checker = resolved_.checker;
  components_.push_back(std::make_shared<const SampledComponents>(
      std::get<std::shared_ptr<const ComponentSource>>(std::move(recalled)), robot.joint_count(),
      std::move(checker)));
  if (components_.back()->group_count() == 0) return nullptr;
  return make_component_sampler(robot, components_.back(), kind.sigma);
}

std::shared_ptr<const Sampler> MemorySampler::sample_mixture(const KindSettings& kind,
                                                             GaussianMixture mixture) {
  if (kind.drop_invalid_means) mixture = keep_valid_components(resolved_.checker, mixture);
  auto own = std::make_shared<const GaussianMixture>(std::move(mixture));
  if (gl_.mixture == nullptr) {
    gl_.mixture = own;
  } else {
    add_to_found(*own);
  }
  if (own->component_count() == 0) return nullptr;
  return make_mixture_sampler(query().problem.robot, std::move(own), kind.sigma, kind.widening);
}

}  // namespace mneme::internal
