// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Nearest keys among rows that come and, rarely, go.
#pragma once

#include "experience/key_tree.h"

#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>

namespace mneme::internal {

/// A few trees, each at least about twice as large as the next: a new one takes in those that are
/// not larger than itself (Bentley and Saxe, "Decomposable searching problems I", 1980). A copy
/// shares the trees, which never change: who writes changes a copy while others search the index as
/// it was. Const is parallel-safe.
class ExperienceIndex {
 public:
  explicit ExperienceIndex(int key_size) : key_size_(key_size) {}
  /// Of the trees() of another.
  ExperienceIndex(int key_size, std::vector<std::shared_ptr<const KeyTree>> trees);

  /// O(log^2 size) per row, seen over all of them.
  void append(IndexRows rows);
  void remove(const std::function<bool(std::int64_t)>& is_gone);

  /// The rows whose key's squared distance to the nearest of `images` is less than `threshold`:
  /// nearest first, ties by id, at most `max_matches` (0: all).
  [[nodiscard]] std::vector<IndexMatch> find(std::span<const std::vector<double>> images,
                                             double threshold, int max_matches) const;

  [[nodiscard]] int key_size() const { return key_size_; }
  [[nodiscard]] std::int64_t size() const { return size_; }
  /// Of all rows together.
  [[nodiscard]] std::int64_t components() const { return components_; }
  /// Of the row at a position in order of insertion, 0 to size() - 1.
  [[nodiscard]] std::int64_t id(std::int64_t position) const;
  [[nodiscard]] const std::vector<std::shared_ptr<const KeyTree>>& trees() const { return trees_; }

 private:
  void count();

  int key_size_;
  std::vector<std::shared_ptr<const KeyTree>> trees_;
  std::int64_t size_ = 0;
  std::int64_t components_ = 0;
};

/// The indexes of all kinds of rows.
using KindIndexes = std::map<std::string, ExperienceIndex, std::less<>>;

}  // namespace mneme::internal
