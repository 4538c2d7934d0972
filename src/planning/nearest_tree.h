// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A tree for nearest-neighbour queries.
#pragma once

#include "planning/configuration_blocks.h"
#include "planning/nearest_kernels.h"
#include "robot/joint_space.h"

#include <array>
#include <span>
#include <utility>
#include <vector>

namespace mneme::internal {

/// A k-d tree with blocks of configurations as leaves (Bentley, DOI 10.1145/361002.361007). Queries
/// do not descend it: they measure the boxes of all leaves, a vector at a time, and scan the leaves
/// that are near enough. Not thread-safe, not even for queries alone.
class NearestTree {
 public:
  /// `space` must outlive the tree.
  NearestTree(const JointSpace& space, Isa isa);

  [[nodiscard]] int size() const { return size_; }
  /// Adds `q` as configuration number size().
  void add(std::span<const float> q);
  /// Number and squared distance of the configuration nearest to `q`. The tree must not be empty.
  [[nodiscard]] std::pair<int, float> nearest(std::span<const float> q);
  void clear();

 private:
  struct Leaf {
    int count = 0;
    std::vector<float> lower, upper;  ///< its box
  };
  /// Configurations below `value` are in one child, the others in the other. A child is a node, or
  /// a leaf if it is ~leaf.
  struct Node {
    std::size_t joint = 0;
    float value = 0;
    std::array<int, 2> children = {};
  };

  int add_leaf();
  void put(int leaf, std::span<const float> q, int number);
  /// Moves the upper half of a full leaf into a new one. Returns the node that divides them.
  Node split(int leaf);
  void write_box(int leaf);

  const JointSpace& space_;
  const NearestKernels& kernels_;
  int size_ = 0;
  int root_ = ~0;
  std::vector<Node> nodes_;
  std::vector<Leaf> leaves_;
  ConfigurationBlocks blocks_;
  std::vector<int> numbers_;  ///< of the configurations, per place in the blocks
  std::vector<float> boxes_;  ///< see LeafTable
  std::vector<float> distances_;
};

}  // namespace mneme::internal
