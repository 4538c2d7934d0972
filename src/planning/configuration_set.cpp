// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/configuration_set.h"

#include <algorithm>
#include <limits>

namespace mneme::internal {

namespace {

/// Number of configurations from which a tree query costs less than a scan.
constexpr int kLeastForTree = 2048;

}  // namespace

int ConfigurationSet::add(std::span<const float> q) {
  rows_.insert(rows_.end(), q.begin(), q.end());
  if (size_ % kBlockSize == 0) blocks_.append();
  blocks_.put(size_, q);
  return size_++;
}

std::pair<int, float> ConfigurationSet::nearest(std::span<const float> q) const {
  if (size_ < kLeastForTree) {
    return kernels_.nearest(blocks_.data(), blocks_.count(), space_.joint_count(), q.data(),
                            space_.periods().data());
  }
  while (tree_.size() < size_) tree_.add((*this)[tree_.size()]);
  return tree_.nearest(q);
}

void ConfigurationSet::clear() {
  size_ = 0;
  measured_ = 0;
  rows_.clear();
  blocks_.clear();
  tree_.clear();
}

void ConfigurationSet::measure(std::span<const float> q) {
  measured_ = size_;
  distances_.resize(static_cast<std::size_t>(blocks_.count()) * kBlockSize);
  kernels_.distances(blocks_.data(), blocks_.count(), space_.joint_count(), q.data(),
                     space_.periods().data(), distances_.data());
}

void ConfigurationSet::find_nearest(int count, std::vector<int>& indices) {
  // A heap with the farthest of the nearest on top: nearly all candidates fail one comparison.
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
