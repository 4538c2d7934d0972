// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/tree.h"

#include <algorithm>

namespace mneme::internal {

int Tree::add(std::span<const float> q, int parent) {
  parents_.push_back(parent);
  return nodes_.add(q);
}

int Tree::root_of(int node) const {
  while (parents_[static_cast<std::size_t>(node)] >= 0)
    node = parents_[static_cast<std::size_t>(node)];
  return node;
}

bool Tree::is_step_short(int node, std::span<const float> q) {
  const std::span<const float> from = nodes_[node];
  const float length = run_.space().difference(from.data(), q.data(), delta_.data());
  if (length <= run_.range()) return false;
  const float fraction = run_.range() / length;
  for (std::size_t j = 0; j < target_.size(); ++j) {
    target_[j] = run_.space().into_limits(static_cast<int>(j), from[j] + fraction * delta_[j]);
  }
  return true;
}

int Tree::extend(int node, std::span<const float> q, bool& is_reached) {
  is_reached = !is_step_short(node, q);
  const std::span<const float> to = is_reached ? q : std::span<const float>(target_);
  return run_.is_motion_valid(nodes_[node], to) ? add(to, node) : -1;
}

int Tree::connect(int node, std::span<const float> q) {
  while (is_step_short(node, q)) {
    if (run_.must_stop() || !run_.is_motion_valid(nodes_[node], target_)) return -1;
    node = add(target_, node);
  }
  return run_.is_motion_valid(nodes_[node], q) ? node : -1;
}

FloatPath Tree::path_to(int node) const {
  FloatPath path;
  for (; node >= 0; node = parents_[static_cast<std::size_t>(node)]) {
    path.emplace_back(nodes_[node].begin(), nodes_[node].end());
  }
  std::reverse(path.begin(), path.end());
  return path;
}

int Tree::ancestor_at(int node, int depth) const {
  std::vector<int> chain;
  for (; node >= 0; node = parents_[static_cast<std::size_t>(node)]) chain.push_back(node);
  return chain[chain.size() - 1 - static_cast<std::size_t>(depth)];
}

void Tree::remove(int node) {
  const auto joints = static_cast<std::size_t>(run_.space().joint_count());
  std::vector<float> rows;
  std::vector<int> parents, new_index(parents_.size(), -1);
  for (int i = 0; i < size(); ++i) {
    const int parent = parents_[static_cast<std::size_t>(i)];
    const bool is_kept =
        i != node && (parent < 0 || new_index[static_cast<std::size_t>(parent)] >= 0);
    if (!is_kept) continue;
    new_index[static_cast<std::size_t>(i)] = static_cast<int>(parents.size());
    parents.push_back(parent < 0 ? -1 : new_index[static_cast<std::size_t>(parent)]);
    rows.insert(rows.end(), nodes_[i].begin(), nodes_[i].end());
  }
  nodes_.clear();
  parents_.clear();
  for (std::size_t i = 0; i < parents.size(); ++i)
    add({rows.data() + i * joints, joints}, parents[i]);
}

}  // namespace mneme::internal
