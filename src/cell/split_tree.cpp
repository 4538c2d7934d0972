// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "cell/split_tree.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace mneme::internal {

TaskBox SplitNode::half(const TaskBox& whole, int side) const {
  TaskBox result = whole;
  const auto k = as_index(parameter);
  result.half[k] /= 2;
  result.center[k] += (side == 0 ? -1 : 1) * result.half[k];
  return result;
}

const SplitNode& SplitTree::leaf_of(const CellTask& task) const {
  const SplitNode* node = &nodes.front();
  while (!node->is_leaf()) node = &nodes[as_index(node->half_of(task))];
  return *node;
}

std::vector<TaskBox> SplitTree::place(const TaskBox& whole) {
  std::vector<TaskBox> boxes(nodes.size());
  boxes.front() = whole;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    SplitNode& node = nodes[i];
    if (node.is_leaf()) continue;
    node.at = boxes[i].center[as_index(node.parameter)];
    for (const int side : {0, 1}) boxes[as_index(node.below + side)] = node.half(boxes[i], side);
  }
  return boxes;
}

int SplitTree::cut(int node, int parameter, double at) {
  const int below = static_cast<int>(nodes.size());
  SplitNode& cut = nodes[as_index(node)];
  cut.parameter = static_cast<std::uint8_t>(parameter);
  cut.at = at;
  cut.below = below;
  cut.has_gap = false;
  nodes.resize(nodes.size() + 2);
  return below;
}

std::uint16_t SplitTree::name_index(const std::string& name) {
  const auto found = std::ranges::find(names, name);
  if (found != names.end()) return static_cast<std::uint16_t>(found - names.begin());
  if (names.size() > std::numeric_limits<std::uint16_t>::max()) return 0;
  names.push_back(name);
  return static_cast<std::uint16_t>(names.size() - 1);
}

UnprovenBox SplitTree::reason_of(const LeafGap& gap) const {
  UnprovenBox reason;
  reason.gap = gap.reason;
  reason.first = names[gap.first];
  reason.other = names[gap.other];
  reason.along = static_cast<double>(gap.along) / LeafGap::kWholePath;
  return reason;
}

void SplitTree::set_gap(int node, const UnprovenBox& reason, bool is_examined) {
  const double along = std::clamp(reason.along, 0.0, 1.0) * LeafGap::kWholePath;
  SplitNode& leaf = nodes[as_index(node)];
  leaf.has_gap = true;
  leaf.gap = {reason.gap,
              is_examined,
              false,
              name_index(reason.first),
              name_index(reason.other),
              static_cast<std::uint8_t>(std::lround(along))};
}

std::vector<UnprovenBox> SplitTree::unproven(const TaskFrame& frame) const {
  const std::vector<TaskBox> boxes = SplitTree(*this).place(frame.whole());
  std::vector<UnprovenBox> result;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (!nodes[i].has_gap) continue;
    result.push_back(reason_of(nodes[i].gap));
    result.back().center = boxes[i].center;
    result.back().half_extents = boxes[i].half;
    result.back().share = frame.share_of(boxes[i]);
  }
  std::ranges::stable_sort(result, std::greater(), &UnprovenBox::share);
  return result;
}

void SplitTree::merge() {
  // Children are behind their parents, so that backwards they come first.
  for (std::size_t i = nodes.size(); i-- > 0;) {
    SplitNode& node = nodes[i];
    if (node.is_leaf()) continue;
    const SplitNode &one = nodes[as_index(node.below)], &other = nodes[as_index(node.below + 1)];
    const bool is_gap = one.is_leaf() && other.is_leaf() && one.has_gap && other.has_gap;
    if (!is_gap || one.count > 0 || other.count > 0 || !one.gap.merges_with(other.gap)) continue;
    node.parameter = SplitNode::kLeaf;
    node.has_gap = true;
    node.gap = one.gap;
    node.gap.is_examined = true;
  }
  std::vector<SplitNode> ordered = {nodes.front()};
  for (std::size_t i = 0; i < ordered.size(); ++i) {
    if (ordered[i].is_leaf()) continue;
    const int below = ordered[i].below;
    ordered[i].below = static_cast<int>(ordered.size());
    for (const int side : {0, 1}) ordered.push_back(nodes[as_index(below + side)]);
  }
  nodes = std::move(ordered);
}

}  // namespace mneme::internal
