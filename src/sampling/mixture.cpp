// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/sampling.h"

#include <cassert>

#include "robot/joint_space.h"

namespace mneme {
namespace {

class MixtureStream final : public SampleStream {
 public:
  MixtureStream(const internal::JointSpace& space, const GaussianMixture& mixture, float sigma,
                std::uint64_t seed)
      : space_(space),
        mixture_(mixture),
        sigma_(sigma),
        component_count_(static_cast<std::uint32_t>(mixture.component_count())),
        rng_(seed) {}

  Origin next(std::span<float> q) override {
    const std::size_t component = rng_.index(component_count_);
    const auto joints = static_cast<std::size_t>(mixture_.joint_count);
    const float* mean = mixture_.means.data() + component * joints;
    const int factor_row = mixture_.factor_rows.empty() ? -1 : mixture_.factor_rows[component];
    if (factor_row < 0) {
      for (std::size_t i = 0; i < joints; ++i) q[i] = mean[i] + sigma_ * normal();
    } else {
      add_correlated(factor_row, mean, q);
    }
    for (std::size_t i = 0; i < joints; ++i) q[i] = space_.into_limits(static_cast<int>(i), q[i]);
    return mixture_.origins.empty() ? 0 : mixture_.origins[component];
  }

 private:
  float normal() { return static_cast<float>(rng_.normal()); }

  /// q = mean + L z for standard normal z. Rows from the last, so that q can hold z meanwhile.
  void add_correlated(int factor_row, const float* mean, std::span<float> q) {
    const auto joints = static_cast<std::size_t>(mixture_.joint_count);
    const float* factor = mixture_.factors.data() +
                          static_cast<std::size_t>(factor_row) * (joints * (joints + 1) / 2);
    for (std::size_t i = 0; i < joints; ++i) q[i] = normal();
    for (std::size_t i = joints; i-- > 0;) {
      const float* row = factor + i * (i + 1) / 2;
      float sum = mean[i];
      for (std::size_t j = 0; j <= i; ++j) sum += row[j] * q[j];
      q[i] = sum;
    }
  }

  const internal::JointSpace& space_;
  const GaussianMixture& mixture_;
  float sigma_;
  std::uint32_t component_count_;
  Rng rng_;
};

class MixtureSampler final : public Sampler {
 public:
  MixtureSampler(const Robot& robot, std::shared_ptr<const GaussianMixture> mixture, double sigma)
      : space_(robot), mixture_(std::move(mixture)), sigma_(static_cast<float>(sigma)) {
    assert(mixture_->component_count() > 0 && mixture_->joint_count == space_.joint_count());
  }
  std::unique_ptr<SampleStream> start(std::uint64_t seed) const override {
    return std::make_unique<MixtureStream>(space_, *mixture_, sigma_, seed);
  }

 private:
  internal::JointSpace space_;
  std::shared_ptr<const GaussianMixture> mixture_;
  float sigma_;
};

}  // namespace

std::unique_ptr<Sampler> make_mixture_sampler(const Robot& robot,
                                              std::shared_ptr<const GaussianMixture> mixture,
                                              double sigma) {
  return std::make_unique<MixtureSampler>(robot, std::move(mixture), sigma);
}

}  // namespace mneme
