// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The keys nearest to a query, as a search collects them.
#pragma once

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstddef>
#include <cstdint>
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
  NearestMatches(double threshold, std::size_t max_matches, std::uint32_t image)
      : threshold_(threshold), max_matches_(max_matches), image_(image) {}

  /// Keys that are not nearer than this need not be offered. A little more than what is still
  /// wanted, because bounds are summed in another order than distances and because keys as far as
  /// the worst match may come before it.
  [[nodiscard]] double bound() const {
    const double worst = is_full() ? matches_.front().error : threshold_;
    return worst * (1 + 1e-12) + DBL_MIN;
  }

  /// A threshold that leaves out nothing of what is among the nearest, of this image and others.
  [[nodiscard]] double limit() const {
    return is_full() ? std::nextafter(matches_.front().error, DBL_MAX) : threshold_;
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
  // A heap, the worst in front, if there is a bound on their number.
  std::vector<IndexMatch> matches_;
};

}  // namespace mneme::internal
