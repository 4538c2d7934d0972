// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The tree of RRT and RRT-Connect.
#pragma once

#include "planning/configuration_set.h"
#include "planning/planner_run.h"

#include <span>
#include <vector>

namespace mneme::internal {

/// Nodes are configurations, edges are valid motions from parent to child. A parent has a lower
/// index than its children. Not thread-safe.
class Tree {
 public:
  /// `graph` is the tree's number for observers.
  explicit Tree(PlannerRun& run, int graph = 0)
      : run_(run), nodes_(run.space(), run.isa()), target_(run.start().size()), graph_(graph) {}

  [[nodiscard]] int size() const { return nodes_.size(); }
  [[nodiscard]] std::span<const float> operator[](int node) const { return nodes_[node]; }

  [[nodiscard]] std::span<const float> newest() const { return nodes_[size() - 1]; }

  /// Adds a node; `parent` is -1 for a root.
  int add(std::span<const float> q, int parent);
  [[nodiscard]] int nearest(std::span<const float> q) const { return nodes_.nearest(q).first; }
  /// The nearest node, or -1 if `q` lies outside its domain and the search is not long.
  [[nodiscard]] int nearest_in_domain(std::span<const float> q) const;
  /// Adapts the domain of `node` after a step: the first failure bounds the domain, further
  /// failures shrink it, and success lets it grow. Dynamic-domain RRT: Jaillet, Yershova, LaValle
  /// and Simeon, DOI 10.1109/IROS.2005.1545607.
  void adapt_domain(int node, bool is_extended);

  /// Writes the end of a step of at most the range from `node` towards `q`. Returns true if the end
  /// is `q`. Under constraints the end is projected onto them, if that is progress towards `q`;
  /// otherwise the end stays off the constraints, where no motion is valid.
  bool step(int node, std::span<const float> q, std::span<float> end) const;
  /// Takes the step of step(). Returns the new node, or -1 if the motion is blocked. Sets
  /// `is_reached` if the step ends at `q`.
  int extend(int node, std::span<const float> q, bool& is_reached);
  /// Steps from `node` towards `q` until blocked. Returns the last node before `q`, which is not
  /// added, or -1 if `q` is not reached.
  int connect(int node, std::span<const float> q);

  /// Configurations from the root to `node`.
  [[nodiscard]] FloatPath path_to(int node) const;
  /// The ancestor of `node` that is `depth` edges from the root.
  [[nodiscard]] int ancestor_at(int node, int depth) const;
  /// Removes `node`, which must not be a root, and its descendants. O(size).
  void remove(int node);

 private:
  void project(std::span<const float> q, float length, std::span<float> end) const;
  int append(std::span<const float> q, int parent);

  PlannerRun& run_;
  ConfigurationSet nodes_;
  std::vector<int> parents_;
  std::vector<float> domains_;  ///< squared radius per node
  std::vector<float> target_;
  int graph_;
};

}  // namespace mneme::internal
