// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/configuration_set.h"

#include <algorithm>
#include <numeric>

namespace mneme::internal {

int ConfigurationSet::add(std::span<const float> q) {
  const int index = size_++;
  const auto lane = static_cast<std::size_t>(index % kBlockSize);
  rows_.insert(rows_.end(), q.begin(), q.end());
  if (lane == 0) {
    for (std::size_t j = 0; j < joints(); ++j) blocks_.insert(blocks_.end(), kBlockSize, rows_[j]);
  }
  float* block = blocks_.data() + static_cast<std::size_t>(index / kBlockSize) * kBlockSize * joints();
  for (std::size_t j = 0; j < joints(); ++j) block[j * kBlockSize + lane] = q[j];
  return index;
}

void ConfigurationSet::clear() {
  size_ = 0;
  rows_.clear();
  blocks_.clear();
}

void ConfigurationSet::nearest(std::span<const float> q, int count, std::vector<int>& indices) {
  distances_.resize(static_cast<std::size_t>(block_count()) * kBlockSize);
  kernels_.distances(blocks_.data(), block_count(), space_.joint_count(), q.data(), space_.periods().data(),
                     distances_.data());
  indices.resize(static_cast<std::size_t>(size_));
  std::iota(indices.begin(), indices.end(), 0);
  const auto is_nearer = [&](int a, int b) {
    const float distance_a = distances_[static_cast<std::size_t>(a)];
    const float distance_b = distances_[static_cast<std::size_t>(b)];
    return distance_a != distance_b ? distance_a < distance_b : a < b;
  };
  const auto end = indices.begin() + std::min(count, size_);
  std::nth_element(indices.begin(), end, indices.end(), is_nearer);
  std::sort(indices.begin(), end, is_nearer);
  indices.erase(end, indices.end());
}

}  // namespace mneme::internal
