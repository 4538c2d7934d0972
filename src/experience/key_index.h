// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Nearest-neighbour index over keys, with insertion and rare removal.
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
  std::int64_t id = 0;      ///< id of its row
  std::uint32_t image = 0;  ///< index of the nearest image of the query; the first of equals
  double error = 0;         ///< squared distance to that image
};

inline bool is_nearer(const IndexMatch& a, const IndexMatch& b) {
  return std::tie(a.error, a.id) < std::tie(b.error, b.id);
}

/// The nearest keys to one image under a threshold, ties by id; at most `max_matches` (0: all).
class NearestMatches {
 public:
  /// `keys_left`, if not null, is the number of keys that may still be inspected.
  NearestMatches(double threshold, std::size_t max_matches, std::uint32_t image,
                 std::int64_t* keys_left = nullptr)
      : threshold_(threshold), max_matches_(max_matches), image_(image), keys_left_(keys_left) {}

  /// Keys beyond this squared distance need not be offered. Slightly above the exact limit, because
  /// bounds are summed in another order than distances, and ties are broken by id.
  [[nodiscard]] double bound() const {
    if (keys_left_ != nullptr && *keys_left_ <= 0) return -1;
    const double worst = is_full() ? matches_.front().error : threshold_;
    return worst * (1 + 1e-12) + DBL_MIN;
  }

  /// A threshold for further images that excludes no key among the nearest of all images.
  [[nodiscard]] double limit() const {
    return is_full() ? std::nextafter(matches_.front().error, DBL_MAX) : threshold_;
  }

  void count_inspected(std::size_t keys) {
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

  /// In arbitrary order.
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

/// Rows of an index, in order of insertion.
struct IndexRows {
  std::vector<std::int64_t> ids;
  std::vector<std::int32_t> components;
  std::vector<double> keys;  ///< concatenated; finite, at most kMaxKeyMagnitude
};

/// Rows of a tree, with keys in the order of its leaves. A leaf stores the first number of each of
/// its keys, then the second of each, and so on, for a sequential scan. The leaves follow from the
/// number of keys: every node passes half of them to each child.
struct KeyTreeData {
  std::vector<std::int64_t> ids;         ///< in order of insertion
  std::vector<std::int32_t> components;  ///< numbers of components, in the same order
  std::vector<std::uint32_t> order;      ///< per key in the tree: its index in `ids`
  std::vector<double> keys;
};

/// Const is parallel-safe.
class KeyTree {
 public:
  /// Most keys in a leaf; part of the format of data().
  static constexpr std::size_t kLeafSize = 64;

  /// O(n log n).
  KeyTree(int key_size, IndexRows rows);
  /// Restores a tree from its data(); O(n). Sizes must fit, and `order` must be a permutation.
  KeyTree(int key_size, KeyTreeData data);

  [[nodiscard]] std::size_t size() const { return data_.ids.size(); }
  /// Sum over all rows.
  [[nodiscard]] std::int64_t components() const { return components_; }
  [[nodiscard]] const KeyTreeData& data() const { return data_; }
  [[nodiscard]] IndexRows rows() const;

  /// Offers all keys within nearest.bound() of `query`. Squared distances are summed from the first
  /// number to the last.
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
  std::vector<std::size_t> begins_;  // begin of each leaf, and the end
  CoarseKeys coarse_;
};

/// A few trees, each at least about twice as large as the next; a new tree absorbs smaller ones
/// (Bentley and Saxe, "Decomposable searching problems I", 1980). Copies share the immutable trees,
/// so a writer can change a copy while others search. Const is parallel-safe.
class ExperienceIndex {
 public:
  explicit ExperienceIndex(int key_size) : key_size_(key_size) {}
  /// Makes an index from the trees() of another.
  ExperienceIndex(int key_size, std::vector<std::shared_ptr<const KeyTree>> trees);

  /// O(log^2 size) per row, amortized.
  void append(IndexRows rows);
  void remove(const std::function<bool(std::int64_t)>& is_removed);

  /// Rows with a squared key distance below `threshold` to the nearest of `images`: nearest first,
  /// ties by id, at most `max_matches` (0: all). `keys_left`, if not null, limits the keys
  /// inspected and is reduced leaf by leaf; at 0 the search ends.
  [[nodiscard]] std::vector<IndexMatch> find(std::span<const std::vector<double>> images,
                                             double threshold, int max_matches,
                                             std::int64_t* keys_left = nullptr) const;

  [[nodiscard]] int key_size() const { return key_size_; }
  [[nodiscard]] std::int64_t size() const { return size_; }
  /// Number of components of all rows.
  [[nodiscard]] std::int64_t components() const { return components_; }
  /// Id of the row at a position in order of insertion, 0 to size() - 1.
  [[nodiscard]] std::int64_t id(std::int64_t position) const;
  [[nodiscard]] const std::vector<std::shared_ptr<const KeyTree>>& trees() const { return trees_; }

 private:
  void count();

  int key_size_;
  std::vector<std::shared_ptr<const KeyTree>> trees_;
  std::int64_t size_ = 0;
  std::int64_t components_ = 0;
};

/// Rows that are searched together: one kind and one hash of constraints.
struct RowGroup {
  std::string kind;
  std::uint64_t constraints = 0;
  auto operator<=>(const RowGroup&) const = default;
};
using GroupIndexes = std::map<RowGroup, ExperienceIndex>;

}  // namespace mneme::internal
