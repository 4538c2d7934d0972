// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Nearest keys among rows that come and, rarely, go.
#pragma once

#include "experience/coarse_keys.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <vector>

namespace mneme::internal {

/// A key near a query.
struct IndexMatch {
  std::int64_t id = 0;      ///< of its row
  std::uint32_t image = 0;  ///< the image of the query that is nearest; the first of equals
  double error = 0;         ///< squared distance to it
};

inline bool is_nearer(const IndexMatch& a, const IndexMatch& b) {
  return std::tie(a.error, a.id) < std::tie(b.error, b.id);
}

/// The nearest keys to one image under a threshold, ties by id; at most `max_matches` (0: all).
class NearestMatches {
 public:
  /// `keys_left`, if it is not null, counts down the keys that may be looked at.
  NearestMatches(double threshold, std::size_t max_matches, std::uint32_t image,
                 std::int64_t* keys_left = nullptr)
      : threshold_(threshold), max_matches_(max_matches), image_(image), keys_left_(keys_left) {}

  /// Keys that are not nearer than this need not be offered. A little more than what is still
  /// wanted, because bounds are summed in another order than distances and because keys as far as
  /// the worst match may come before it.
  [[nodiscard]] double bound() const {
    if (keys_left_ != nullptr && *keys_left_ <= 0) return -1;
    const double worst = is_full() ? matches_.front().error : threshold_;
    return worst * (1 + 1e-12) + DBL_MIN;
  }

  /// A threshold that leaves out nothing of what is among the nearest, of this image and others.
  [[nodiscard]] double limit() const {
    return is_full() ? std::nextafter(matches_.front().error, DBL_MAX) : threshold_;
  }

  void look_at(std::size_t keys) {
    if (keys_left_ != nullptr) *keys_left_ -= static_cast<std::int64_t>(keys);
  }

  void offer(double error, std::int64_t id) {
    const IndexMatch match{id, image_, error};
    if (!(error < threshold_)) return;
    if (is_full()) {
      if (!is_nearer(match, matches_.front())) return;
      std::pop_heap(matches_.begin(), matches_.end(), is_nearer);
      matches_.back() = match;
    } else {
      matches_.push_back(match);
    }
    if (max_matches_ > 0) std::push_heap(matches_.begin(), matches_.end(), is_nearer);
  }

  /// In no particular order.
  [[nodiscard]] const std::vector<IndexMatch>& matches() const { return matches_; }

 private:
  [[nodiscard]] bool is_full() const { return max_matches_ > 0 && matches_.size() >= max_matches_; }

  double threshold_;
  std::size_t max_matches_;
  std::uint32_t image_;
  std::int64_t* keys_left_;
  // A heap, the worst in front, if there is a bound on their number.
  std::vector<IndexMatch> matches_;
};

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
  /// The squared distance of a key of a leaf.
  [[nodiscard]] double distance(std::size_t leaf, std::size_t i, const double* query) const;
  /// `near` has a bit per key.
  void offer(std::size_t leaf, std::uint64_t near, const double* query,
             NearestMatches& nearest) const;

  std::size_t key_size_;
  KeyTreeData data_;
  std::int64_t components_;
  std::vector<std::size_t> begins_;  // of the leaves, and the end of the last
  CoarseKeys coarse_;
};

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
  /// nearest first, ties by id, at most `max_matches` (0: all). Of `keys_left`, if it is not null,
  /// the keys that were looked at are taken, a leaf at a time; without any left, it ends with what
  /// it has.
  [[nodiscard]] std::vector<IndexMatch> find(std::span<const std::vector<double>> images,
                                             double threshold, int max_matches,
                                             std::int64_t* keys_left = nullptr) const;

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

/// Rows that one search is among: those of a kind, and of paths those under the same constraints.
struct RowGroup {
  std::string kind;
  std::uint64_t constraints = 0;
  auto operator<=>(const RowGroup&) const = default;
};
using GroupIndexes = std::map<RowGroup, ExperienceIndex>;

}  // namespace mneme::internal
