// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/sampled_components.h"

namespace mneme::internal {

SampledComponents::SampledComponents(std::shared_ptr<const ComponentSource> source, int joint_count,
                                     std::optional<CollisionChecker> checker)
    : source_(std::move(source)), checker_(std::move(checker)) {
  made_.joint_count = joint_count;
  std::size_t count = 0;
  for (int group = 0; group < source_->group_count(); ++group) {
    first_.push_back(count);
    count += static_cast<std::size_t>(source_->component_count(group));
  }
  is_noted_.resize(count);
}

bool SampledComponents::make(int group, int component, std::span<float> mean) const {
  if (!source_->make(group, component, mean)) return false;
  if (checker_ && !checker_->is_valid(std::span<const float>(mean))) return false;
  note(group, component, mean);
  return true;
}

void SampledComponents::note(int group, int component, std::span<const float> mean) const {
  const std::size_t number =
      first_[static_cast<std::size_t>(group)] + static_cast<std::size_t>(component);
  const std::lock_guard lock(mutex_);
  if (is_noted_[number] != 0) return;
  is_noted_[number] = 1;
  made_.means.insert(made_.means.end(), mean.begin(), mean.end());
  made_.sources.push_back(source_->sample_source(group));
  made_.add_factor(source_->factor(group, component));
}

GaussianMixture SampledComponents::made() const {
  const std::lock_guard lock(mutex_);
  return made_;
}

}  // namespace mneme::internal
