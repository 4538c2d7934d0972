// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A k-d tree over keys that never changes.
#pragma once

#include "experience/nearest_matches.h"

#include <span>

namespace mneme::internal {

/// What an index knows of its rows, in order of their insertion.
struct IndexRows {
  std::vector<std::int64_t> ids;
  std::vector<std::int32_t> components;
  std::vector<double> keys;  ///< one after the other; finite, at most kMaxKeyMagnitude
};

/// The keys of some rows in the order of the tree's leaves. A leaf holds the first numbers of its
/// keys, then the second ones, and so on, so that a scan of it needs no jumps. Which keys belong to
/// a leaf follows from their number: every node hands half of them to each child.
struct KeyTreeData {
  std::vector<std::int64_t> ids;         ///< in order of insertion
  std::vector<std::int32_t> components;  ///< likewise
  std::vector<std::uint32_t> order;      ///< per key in the tree: its place in `ids`
  std::vector<double> keys;
};

/// Const is parallel-safe.
class KeyTree {
 public:
  /// Keys in a leaf, at most: data() of another number means something else.
  static constexpr std::size_t kLeafSize = 64;

  /// O(n log n).
  KeyTree(int key_size, IndexRows rows);
  /// Of data() that was kept: O(n). The sizes must fit, and `order` must be a permutation.
  KeyTree(int key_size, KeyTreeData data);

  [[nodiscard]] std::size_t size() const { return data_.ids.size(); }
  /// Of all rows together.
  [[nodiscard]] std::int64_t components() const { return components_; }
  [[nodiscard]] const KeyTreeData& data() const { return data_; }
  [[nodiscard]] IndexRows rows() const;

  /// Offers all keys that are nearer to `query` than what `nearest` still wants. Their squared
  /// distances are summed from the first number to the last.
  void search(const double* query, NearestMatches& nearest) const;

 private:
  struct Node {
    std::size_t index;  ///< the root is 1, the children of i are 2 i and 2 i + 1
    std::size_t begin;
    std::size_t end;
  };
  [[nodiscard]] bool is_leaf(const Node& node) const { return node.index >= leaves_; }
  [[nodiscard]] static Node child(const Node& node, std::size_t which);
  void bound(const Node& node);
  void search(const Node& node, const double* query, NearestMatches& nearest) const;
  void scan(const Node& leaf, const double* query, NearestMatches& nearest) const;
  [[nodiscard]] double distance_to_box(const Node& node, const double* query) const;

  std::size_t key_size_;
  std::size_t leaves_;
  KeyTreeData data_;
  std::int64_t components_;
  std::vector<double> boxes_;  // per node: lower bounds, then upper bounds
};

}  // namespace mneme::internal
