// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/tree.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mneme::internal {
namespace {

/// Factor on squared radii, as in VAMP.
constexpr float kDomainGrowth = 1.0002f;
constexpr float kLeastDomain = 1;
/// Least progress of a projected step, as a share of the range; less would walk in circles.
constexpr float kLeastProgress = 0.1f;

}  // namespace

int Tree::add(std::span<const float> q, int parent) {
  if (parent >= 0) run_.show_edge(nodes_[parent], q, graph_);
  return append(q, parent);
}

int Tree::append(std::span<const float> q, int parent) {
  run_.count_nodes(1);
  parents_.push_back(parent);
  domains_.push_back(std::numeric_limits<float>::infinity());
  return nodes_.add(q);
}

int Tree::nearest_in_domain(std::span<const float> q) const {
  const auto [node, squared_distance] = nodes_.nearest(q);
  const bool is_inside = squared_distance <= domains_[static_cast<std::size_t>(node)];
  return is_inside || run_.is_long_search() ? node : -1;
}

void Tree::adapt_domain(int node, bool is_extended) {
  float& domain = domains_[static_cast<std::size_t>(node)];
  if (is_extended) {
    domain *= kDomainGrowth;
  } else if (std::isinf(domain)) {
    domain = run_.first_domain();
  } else {
    domain = std::max(domain / kDomainGrowth, kLeastDomain);
  }
}

bool Tree::step(int node, std::span<const float> q, std::span<float> end) const {
  const std::span<const float> from = nodes_[node];
  const float length = run_.space().difference(from.data(), q.data(), end.data());
  if (length <= run_.range()) {
    std::copy(q.begin(), q.end(), end.begin());
    return true;
  }
  const float fraction = run_.range() / length;
  for (std::size_t j = 0; j < end.size(); ++j) {
    end[j] = run_.space().into_limits(static_cast<int>(j), from[j] + fraction * end[j]);
  }
  if (!run_.checker().constraints().empty()) project(q, length, end);
  return false;
}

/// `length`: distance to `q` before the step.
void Tree::project(std::span<const float> q, float length, std::span<float> end) const {
  std::vector<float> projected(end.begin(), end.end()), delta(end.size());
  if (!run_.checker().project(projected)) return;
  const float left = run_.space().difference(projected.data(), q.data(), delta.data());
  if (left < length - kLeastProgress * run_.range()) std::ranges::copy(projected, end.begin());
}

int Tree::extend(int node, std::span<const float> q, bool& is_reached) {
  is_reached = step(node, q, target_);
  return run_.is_motion_valid(nodes_[node], target_) ? add(target_, node) : -1;
}

int Tree::connect(int node, std::span<const float> q) {
  while (!step(node, q, target_)) {
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
  std::vector<float> domains;
  for (std::size_t i = 0; i < new_index.size(); ++i) {
    if (new_index[i] >= 0) domains.push_back(domains_[i]);
  }
  run_.count_nodes(-size());
  nodes_.clear();
  parents_.clear();
  for (std::size_t i = 0; i < parents.size(); ++i)
    append({rows.data() + i * joints, joints}, parents[i]);
  domains_ = std::move(domains);
}

}  // namespace mneme::internal
