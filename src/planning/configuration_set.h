// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A growing set of configurations with nearest-neighbour queries: a linear scan, or a tree once
/// the set is large.
#pragma once

#include "mneme/base.h"

#include "planning/configuration_blocks.h"
#include "planning/nearest_kernels.h"
#include "planning/nearest_tree.h"
#include "robot/joint_space.h"

#include <span>
#include <utility>
#include <vector>

namespace mneme::internal {

/// Not thread-safe, not even for queries alone.
class ConfigurationSet {
 public:
  /// `space` must outlive the set.
  ConfigurationSet(const JointSpace& space, Isa isa)
      : space_(space),
        kernels_(nearest_kernels(isa)),
        blocks_(space.joint_count()),
        tree_(space, isa) {}

  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] std::span<const float> operator[](int index) const {
    return {rows_.data() + static_cast<std::size_t>(index) * joints(), joints()};
  }
  /// Returns the new configuration's index.
  int add(std::span<const float> q);
  void clear();

  /// Index and squared distance of the configuration nearest to `q`. The set must not be empty.
  [[nodiscard]] std::pair<int, float> nearest(std::span<const float> q) const;
  /// Measures the squared distances from `q` to all configurations, for the queries below. O(size).
  void measure(std::span<const float> q);
  /// Finds up to `count` configurations nearest to the last measured `q`, nearest first. O(size).
  void find_nearest(int count, std::vector<int>& indices);
  /// The nearest of `candidates`, all of them measured; -1 if there are none.
  [[nodiscard]] int find_nearest_of(std::span<const int> candidates) const;

 private:
  [[nodiscard]] std::size_t joints() const {
    return static_cast<std::size_t>(space_.joint_count());
  }

  const JointSpace& space_;
  const NearestKernels& kernels_;
  int size_ = 0;
  std::vector<float> rows_;
  ConfigurationBlocks blocks_;
  mutable NearestTree tree_;  ///< of the first tree_.size() configurations
  int measured_ = 0;          ///< number of valid distances_
  std::vector<float> distances_;
  std::vector<std::pair<float, int>> heap_;
};

}  // namespace mneme::internal
