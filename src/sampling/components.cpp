// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/sampling.h"

#include "robot/joint_space.h"
#include "sampling/sampler_of.h"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace mneme {
namespace {

class ComponentStream final : public SampleStream {
 public:
  ComponentStream(const internal::JointSpace& space, const ComponentSource& source,
                  std::span<const float> sigmas, std::unique_ptr<SampleStream> rest,
                  std::uint64_t seed)
      : space_(space), source_(source), sigmas_(sigmas), rest_(std::move(rest)), rng_(seed) {
    open(source_.first_groups());
  }

  SampleSource next(std::span<float> q) override {
    if (++samples_ % ComponentSource::kSamplesPerGroup == 0) open(opened_ + 1);
    for (;;) {
      if (choices_.empty() && opened_ < source_.group_count()) open(opened_ + 1);
      if (choices_.empty()) {
        if (opened_ < source_.group_count()) continue;
        return rest_->next(q);
      }
      const std::size_t i = rng_.index(static_cast<std::uint32_t>(choices_.size()));
      if (make(choices_[i])) return sample(choices_[i], q);
      choices_[i] = choices_.back();
      choices_.pop_back();
    }
  }

 private:
  struct Choice {
    int group = 0, component = 0;
    std::size_t begin = kUnmade;  ///< index of its mean in `means_`
  };
  static constexpr std::size_t kUnmade = std::numeric_limits<std::size_t>::max();

  void open(int count) {
    for (; opened_ < std::min(count, source_.group_count()); ++opened_) {
      for (int i = 0; i < source_.component_count(opened_); ++i) choices_.push_back({opened_, i});
    }
  }

  /// Computes its mean, unless it is known. Returns false if there is none.
  bool make(Choice& choice) {
    if (choice.begin != kUnmade) return true;
    const std::size_t begin = means_.size();
    means_.resize(begin + sigmas_.size());
    if (!source_.make(choice.group, choice.component, {means_.data() + begin, sigmas_.size()})) {
      means_.resize(begin);
      return false;
    }
    choice.begin = begin;
    return true;
  }

  SampleSource sample(const Choice& choice, std::span<float> q) {
    const std::span<const float> mean(means_.data() + choice.begin, sigmas_.size());
    const std::span<const float> factor = source_.factor(choice.group, choice.component);
    for (std::size_t j = 0; j < q.size(); ++j) q[j] = rng_.bell();
    // From the last row, because q holds the normal values meanwhile.
    for (std::size_t j = q.size(); j-- > 0;) {
      float sum = 0;
      if (factor.empty()) {
        sum = sigmas_[j] * q[j];
      } else {
        const float* row = factor.data() + triangle_size(j);
        for (std::size_t k = 0; k <= j; ++k) sum += row[k] * q[k];
      }
      q[j] = space_.into_limits(static_cast<int>(j), mean[j] + sum);
    }
    return source_.sample_source(choice.group);
  }

  const internal::JointSpace& space_;
  const ComponentSource& source_;
  std::span<const float> sigmas_;       ///< per joint
  std::unique_ptr<SampleStream> rest_;  ///< used if there are no components
  Rng rng_;
  std::uint64_t samples_ = 0;
  int opened_ = 0;  ///< number of groups that take part
  std::vector<Choice> choices_;
  std::vector<float> means_;
};

}  // namespace

std::unique_ptr<Sampler> make_component_sampler(const Robot& robot,
                                                std::shared_ptr<const ComponentSource> source,
                                                double sigma) {
  return internal::sampler_of(
      [space = internal::JointSpace(robot), source = std::move(source),
       sigmas = internal::joint_deviations(robot, sigma),
       rest = std::shared_ptr(make_uniform_sampler(robot))](std::uint64_t seed) {
        return std::make_unique<ComponentStream>(space, *source, sigmas,
                                                 rest->start(derive_seed(seed, 1)), seed);
      });
}

}  // namespace mneme
