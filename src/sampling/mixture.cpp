// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/sampling.h"

#include "robot/joint_space.h"
#include "sampling/sampler_of.h"

#include <algorithm>
#include <cassert>

namespace mneme {
namespace {

class MixtureStream final : public SampleStream {
 public:
  MixtureStream(const internal::JointSpace& space, const GaussianMixture& mixture,
                std::span<const float> sigmas, const Widening& widening, std::uint64_t seed)
      : space_(space),
        mixture_(mixture),
        sigmas_(sigmas),
        widening_(widening),
        open_(widening.first),
        component_count_(static_cast<std::uint32_t>(mixture.component_count())),
        rng_(seed) {}

  SampleSource next(std::span<float> q) override {
    const std::size_t component = rng_.index(open_component_count());
    const auto joints = static_cast<std::size_t>(mixture_.joint_count);
    const float* mean = mixture_.means.data() + component * joints;
    const std::span<const float> factor = mixture_.factor(static_cast<int>(component));
    if (factor.empty()) {
      for (std::size_t i = 0; i < joints; ++i) q[i] = mean[i] + sigmas_[i] * normal();
    } else {
      add_correlated(factor, mean, q);
    }
    for (std::size_t i = 0; i < joints; ++i) q[i] = space_.into_limits(static_cast<int>(i), q[i]);
    return mixture_.sources.empty() ? 0 : mixture_.sources[component];
  }

 private:
  std::uint32_t open_component_count() {
    if (widening_.first <= 0 || open_ >= component_count_) return component_count_;
    const auto open = static_cast<std::uint32_t>(std::max(1.0, open_));
    open_ += widening_.growth;
    return open;
  }

  float normal() { return static_cast<float>(rng_.normal()); }

  /// q = mean + L z for standard normal z. From the last row, because q holds z meanwhile.
  void add_correlated(std::span<const float> factor, const float* mean, std::span<float> q) {
    const auto joints = static_cast<std::size_t>(mixture_.joint_count);
    for (std::size_t i = 0; i < joints; ++i) q[i] = normal();
    for (std::size_t i = joints; i-- > 0;) {
      const float* row = factor.data() + triangle_size(i);
      float sum = mean[i];
      for (std::size_t j = 0; j <= i; ++j) sum += row[j] * q[j];
      q[i] = sum;
    }
  }

  const internal::JointSpace& space_;
  const GaussianMixture& mixture_;
  std::span<const float> sigmas_;  ///< per joint
  Widening widening_;
  double open_;  ///< number of components open to the next sample
  std::uint32_t component_count_;
  Rng rng_;
};

}  // namespace

std::unique_ptr<Sampler> make_mixture_sampler(const Robot& robot,
                                              std::shared_ptr<const GaussianMixture> mixture,
                                              double sigma, const Widening& widening) {
  internal::JointSpace space(robot);
  assert(mixture->component_count() > 0 && mixture->joint_count == space.joint_count());
  return internal::sampler_of([space = std::move(space), mixture = std::move(mixture),
                               sigmas = internal::joint_deviations(robot, sigma),
                               widening](std::uint64_t seed) {
    return std::make_unique<MixtureStream>(space, *mixture, sigmas, widening, seed);
  });
}

}  // namespace mneme
