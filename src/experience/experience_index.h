// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Nearest canonical keys: a k-d tree over most of them, and a scan of the few that came since it
/// was built.
#pragma once

#include "mneme/primitive.h"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace mneme::internal {

/// A key near a query.
struct IndexMatch {
  std::uint32_t position = 0;  ///< in order of append()
  std::uint32_t image = 0;     ///< the image of the query that is nearest; the first of equals
  double error = 0;            ///< squared distance to it
};

/// Const is parallel-safe.
class ExperienceIndex {
 public:
  explicit ExperienceIndex(int key_size);
  ~ExperienceIndex();

  /// Adds a key of `key_size` finite numbers; what is added is found at once, and fast after
  /// refresh().
  void append(std::span<const double> key);
  /// Rebuilds the tree if many keys came since the last time: O(log size) per key, seen over all of
  /// them.
  void refresh();

  /// The keys whose squared distance to the nearest of `images` is less than `threshold`: nearest
  /// first, ties by position, at most `max_matches` (0: all).
  [[nodiscard]] std::vector<IndexMatch> find(std::span<const KeyImage> images, double threshold,
                                             int max_matches) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace mneme::internal
