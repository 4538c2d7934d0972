// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/box_tree.h"

#include "base/as_index.h"
#include "base/threads.h"

#include <numeric>

namespace mneme::internal {
namespace {

constexpr int kBitsPerAxis = 10;
/// Parts that take less than a millisecond.
constexpr int kPolled = 1 << 13;

/// Inserts two zero bits after each of ten bits.
std::uint32_t spread(std::uint32_t x) {
  x = (x | x << 16) & 0x030000ff;
  x = (x | x << 8) & 0x0300f00f;
  x = (x | x << 4) & 0x030c30c3;
  return (x | x << 2) & 0x09249249;
}

std::vector<std::uint32_t> morton_codes(const std::vector<AxisBox>& boxes) {
  AxisBox centers;
  for (const AxisBox& box : boxes) centers.include(0.5 * (box.low + box.high));
  constexpr double kMost = (1 << kBitsPerAxis) - 1;
  const Vec3 scale = kMost * (centers.high - centers.low).cwiseMax(1e-9).cwiseInverse();
  std::vector<std::uint32_t> codes(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (i % kPolled == 0) poll_interrupt();
    const Vec3 cell = (0.5 * (boxes[i].low + boxes[i].high) - centers.low).cwiseProduct(scale);
    codes[i] = spread(static_cast<std::uint32_t>(cell.x())) |
               spread(static_cast<std::uint32_t>(cell.y())) << 1 |
               spread(static_cast<std::uint32_t>(cell.z())) << 2;
  }
  return codes;
}

/// Indices of `codes` in ascending order, by radix sort.
std::vector<int> sorted_by(const std::vector<std::uint32_t>& codes) {
  constexpr std::uint32_t kDigits = 1 << kBitsPerAxis;
  std::vector<int> order(codes.size()), next(codes.size());
  std::iota(order.begin(), order.end(), 0);
  for (int shift = 0; shift < 3 * kBitsPerAxis; shift += kBitsPerAxis) {
    poll_interrupt();
    std::array<std::size_t, kDigits + 1> begin{};
    const auto digit = [&](int i) { return codes[as_index(i)] >> shift & (kDigits - 1); };
    for (const int i : order) ++begin[digit(i) + 1];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    for (const int i : order) next[begin[digit(i)]++] = i;
    order.swap(next);
  }
  return order;
}

}  // namespace

BoxTree::BoxTree(const std::vector<AxisBox>& boxes, int leaf_size)
    : leaf_size_(leaf_size), order_(sorted_by(morton_codes(boxes))) {
  nodes_.reserve(boxes.size() / 2);
  if (!boxes.empty()) build(boxes, 0, static_cast<int>(boxes.size()));
}

int BoxTree::build(const std::vector<AxisBox>& boxes, int first, int count) {
  if (count > kPolled) poll_interrupt();
  const int index = static_cast<int>(nodes_.size());
  nodes_.push_back({{}, first, count, -1});
  AxisBox box;
  if (count <= leaf_size_) {
    for (int i = first; i < first + count; ++i) box.include(boxes[as_index(order_[as_index(i)])]);
  } else {
    const int half = count / 2;
    const int left = build(boxes, first, half);
    const int right = build(boxes, first + half, count - half);
    box = nodes_[as_index(left)].box;
    box.include(nodes_[as_index(right)].box);
    nodes_[as_index(index)].count = 0;
    nodes_[as_index(index)].right = right;
  }
  nodes_[as_index(index)].box = box;
  return index;
}

}  // namespace mneme::internal
