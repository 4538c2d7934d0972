// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/nearest_tree.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace mneme::internal {

NearestTree::NearestTree(const JointSpace& space, Isa isa)
    : space_(space), kernels_(nearest_kernels(isa)), blocks_(space.joint_count()) {}

int NearestTree::add_leaf() {
  const auto joints = static_cast<std::size_t>(space_.joint_count());
  const int leaf = static_cast<int>(leaves_.size());
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  leaves_.push_back({0, std::vector<float>(joints, kInfinity), std::vector(joints, -kInfinity)});
  for (int i = 0; i < kLeafSize; i += kBlockSize) blocks_.append();
  numbers_.resize(numbers_.size() + kLeafSize);
  if (leaf % kBlockSize == 0) {
    boxes_.resize(boxes_.size() + 2 * kBlockSize * joints, kNoBox);
    distances_.resize(distances_.size() + kBlockSize);
  }
  return leaf;
}

void NearestTree::add(std::span<const float> q) {
  if (leaves_.empty()) add_leaf();
  int* child = &root_;
  const auto descend = [&](Node& node) {
    child = &node.children[q[node.joint] < node.value ? 0 : 1];
  };
  while (*child >= 0) descend(nodes_[static_cast<std::size_t>(*child)]);
  if (leaves_[static_cast<std::size_t>(~*child)].count == kLeafSize) {
    const int leaf = ~*child;
    *child = static_cast<int>(nodes_.size());
    nodes_.push_back(split(leaf));
    descend(nodes_.back());
  }
  const int leaf = ~*child;
  put(leaf, q, size_++);
  write_box(leaf);
}

void NearestTree::put(int leaf, std::span<const float> q, int number) {
  Leaf& row = leaves_[static_cast<std::size_t>(leaf)];
  const int place = leaf * kLeafSize + row.count++;
  blocks_.put(place, q);
  numbers_[static_cast<std::size_t>(place)] = number;
  for (std::size_t j = 0; j < q.size(); ++j) {
    row.lower[j] = std::min(row.lower[j], q[j]);
    row.upper[j] = std::max(row.upper[j], q[j]);
  }
}

NearestTree::Node NearestTree::split(int leaf) {
  const auto joints = static_cast<std::size_t>(space_.joint_count());
  Leaf& full = leaves_[static_cast<std::size_t>(leaf)];
  std::size_t widest = 0;
  for (std::size_t j = 1; j < joints; ++j) {
    if (full.upper[j] - full.lower[j] > full.upper[widest] - full.lower[widest]) widest = j;
  }
  std::array<int, kLeafSize> order;
  std::iota(order.begin(), order.end(), leaf * kLeafSize);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return blocks_.at(a, widest) < blocks_.at(b, widest); });
  constexpr int kHalf = kLeafSize / 2;
  const float value = blocks_.at(order[kHalf], widest);

  std::vector<float> rows;
  std::array<int, kLeafSize> numbers;
  for (std::size_t i = 0; i < kLeafSize; ++i) {
    for (std::size_t j = 0; j < joints; ++j) rows.push_back(blocks_.at(order[i], j));
    numbers[i] = numbers_[static_cast<std::size_t>(order[i])];
    blocks_.remove(order[i]);
  }
  full.count = 0;
  std::fill(full.lower.begin(), full.lower.end(), std::numeric_limits<float>::infinity());
  std::fill(full.upper.begin(), full.upper.end(), -std::numeric_limits<float>::infinity());
  const int other = add_leaf();
  for (std::size_t i = 0; i < kLeafSize; ++i) {
    put(i < kHalf ? leaf : other, {rows.data() + i * joints, joints}, numbers[i]);
  }
  write_box(leaf);
  write_box(other);
  return {widest, value, {~leaf, ~other}};
}

void NearestTree::write_box(int leaf) {
  const Leaf& row = leaves_[static_cast<std::size_t>(leaf)];
  float* box =
      boxes_.data() + leaf / kBlockSize * 2 * kBlockSize * space_.joint_count() + leaf % kBlockSize;
  for (std::size_t j = 0; j < row.lower.size(); ++j, box += 2 * kBlockSize) {
    box[0] = 0.5f * (row.lower[j] + row.upper[j]);
    box[kBlockSize] = 0.5f * (row.upper[j] - row.lower[j]);
  }
}

std::pair<int, float> NearestTree::nearest(std::span<const float> q) {
  const auto [place, squared_distance] =
      kernels_.nearest_in_leaves({blocks_.data(), boxes_.data(), static_cast<int>(leaves_.size()),
                                  space_.joint_count(), space_.periods().data()},
                                 q.data(), distances_.data());
  return {numbers_[static_cast<std::size_t>(place)], squared_distance};
}

void NearestTree::clear() {
  size_ = 0;
  root_ = ~0;
  nodes_.clear();
  leaves_.clear();
  blocks_.clear();
  numbers_.clear();
  boxes_.clear();
  distances_.clear();
}

}  // namespace mneme::internal
