// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Configurations in the layout of the nearest-neighbour kernels.
#pragma once

#include "planning/nearest_kernels.h"

#include <limits>
#include <span>
#include <vector>

namespace mneme::internal {

/// Blocks of kBlockSize places for configurations. Not thread-safe while it changes.
class ConfigurationBlocks {
 public:
  explicit ConfigurationBlocks(int joint_count) : joints_(static_cast<std::size_t>(joint_count)) {}

  [[nodiscard]] int count() const { return static_cast<int>(values_.size() / stride()); }
  [[nodiscard]] const float* data() const { return values_.data(); }
  [[nodiscard]] float at(int place, std::size_t joint) const {
    return values_[offset(place) + joint * kBlockSize];
  }

  /// Appends a block of empty places, which are never the nearest.
  void append() {
    values_.insert(values_.end(), kBlockSize * joints_, 0.0f);
    values_.insert(values_.end(), kBlockSize, std::numeric_limits<float>::infinity());
  }
  void put(int place, std::span<const float> q) {
    float* value = values_.data() + offset(place);
    float sum = 0;
    for (std::size_t j = 0; j < joints_; ++j) {
      value[j * kBlockSize] = q[j];
      sum += q[j] * q[j];
    }
    value[joints_ * kBlockSize] = 0.5f * sum;
  }
  void remove(int place) {
    values_[offset(place) + joints_ * kBlockSize] = std::numeric_limits<float>::infinity();
  }
  void clear() { values_.clear(); }

 private:
  [[nodiscard]] std::size_t stride() const { return kBlockSize * (joints_ + 1); }
  [[nodiscard]] std::size_t offset(int place) const {
    return static_cast<std::size_t>(place / kBlockSize) * stride() +
           static_cast<std::size_t>(place % kBlockSize);
  }

  std::size_t joints_;
  std::vector<float> values_;
};

}  // namespace mneme::internal
