// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/configuration_set.h"

#include <algorithm>
#include <limits>

namespace mneme::internal {

int ConfigurationSet::add(std::span<const float> q) {
  const int index = size_++;
  const auto lane = static_cast<std::size_t>(index % kBlockSize);
  rows_.insert(rows_.end(), q.begin(), q.end());
  if (lane == 0) {
    blocks_.insert(blocks_.end(), kBlockSize * joints(), 0.0f);
    blocks_.insert(blocks_.end(), kBlockSize, std::numeric_limits<float>::infinity());
  }
  float* block =
      blocks_.data() + static_cast<std::size_t>(index / kBlockSize) * kBlockSize * (joints() + 1);
  float sum = 0;
  for (std::size_t j = 0; j < joints(); ++j) {
    block[j * kBlockSize + lane] = q[j];
    sum += q[j] * q[j];
  }
  block[joints() * kBlockSize + lane] = 0.5f * sum;
  return index;
}

void ConfigurationSet::clear() {
  size_ = 0;
  measured_ = 0;
  rows_.clear();
  blocks_.clear();
}

void ConfigurationSet::measure(std::span<const float> q) {
  measured_ = size_;
  distances_.resize(static_cast<std::size_t>(block_count()) * kBlockSize);
  kernels_.distances(blocks_.data(), block_count(), space_.joint_count(), q.data(),
                     space_.periods().data(), distances_.data());
}

void ConfigurationSet::find_nearest(int count, std::vector<int>& indices) {
  // A heap of the nearest so far, farthest on top: nearly all configurations fail the first
  // comparison.
  heap_.clear();
  for (int i = 0; i < measured_; ++i) {
    const std::pair<float, int> candidate = {distances_[static_cast<std::size_t>(i)], i};
    if (static_cast<int>(heap_.size()) == count) {
      if (candidate >= heap_.front()) continue;
      std::pop_heap(heap_.begin(), heap_.end());
      heap_.pop_back();
    }
    heap_.push_back(candidate);
    std::push_heap(heap_.begin(), heap_.end());
  }
  std::sort_heap(heap_.begin(), heap_.end());
  indices.clear();
  for (const auto& [distance, index] : heap_) indices.push_back(index);
}

int ConfigurationSet::find_nearest_of(std::span<const int> candidates) const {
  int best = -1;
  float least = std::numeric_limits<float>::infinity();
  for (const int i : candidates) {
    const float distance = distances_[static_cast<std::size_t>(i)];
    if (distance >= least) continue;
    least = distance;
    best = i;
  }
  return best;
}

}  // namespace mneme::internal
