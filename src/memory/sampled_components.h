// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The components that one query sampled from.
#pragma once

#include "mneme/collision.h"
#include "mneme/sampling.h"

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

namespace mneme::internal {

/// Makes the components of `source` whose means are free, and records them. Const is parallel-safe;
/// streams do not depend on each other.
class SampledComponents final : public ComponentSource {
 public:
  /// Without a checker, means are not checked.
  SampledComponents(std::shared_ptr<const ComponentSource> source, int joint_count,
                    std::optional<CollisionChecker> checker);

  [[nodiscard]] int group_count() const override { return source_->group_count(); }
  [[nodiscard]] int first_groups() const override { return source_->first_groups(); }
  [[nodiscard]] int component_count(int group) const override {
    return source_->component_count(group);
  }
  [[nodiscard]] SampleSource sample_source(int group) const override {
    return source_->sample_source(group);
  }
  [[nodiscard]] bool make(int group, int component, std::span<float> mean) const override;
  [[nodiscard]] std::span<const float> factor(int group, int component) const override {
    return source_->factor(group, component);
  }

  /// Returns the components made so far, in that order.
  [[nodiscard]] GaussianMixture made() const;

 private:
  void note(int group, int component, std::span<const float> mean) const;

  std::shared_ptr<const ComponentSource> source_;
  std::optional<CollisionChecker> checker_;
  std::vector<std::size_t> first_;  ///< per group the index of its first component
  mutable std::mutex mutex_;
  mutable std::vector<std::uint8_t> is_noted_;
  mutable GaussianMixture made_;
};

}  // namespace mneme::internal
