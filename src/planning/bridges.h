// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Remembered motions in a search with two trees.
#pragma once

#include "planning/planner_run.h"
#include "planning/tree.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace mneme::internal {

/// Looks for places of remembered motions during a search, and appends motions that are found to
/// either tree as a whole. A motion through a narrow passage then needs to be reached at one end
/// only. Not thread-safe.
class Bridges {
 public:
  explicit Bridges(PlannerRun& run);

  /// Returns true if the next iteration should append a motion. Looks for another motion before,
  /// as long as this has taken less than a share of the search's work.
  [[nodiscard]] bool is_due();
  /// The tree to append to next: 0 or 1.
  [[nodiscard]] int choose_tree() { return rng_.uniform() < 0.5 ? 0 : 1; }
  /// Connects `tree`, number `graph`, to an end of a random motion that it does not hold, and
  /// appends the motion. Returns the last new node, or -1 if the end is not reached.
  int append(Tree& tree, int graph);
  /// Tells the source what the search has found, and which motions `path` follows; empty: no path.
  void report(const FloatPath& path) const;

 private:
  struct Motion {
    int row = 0;                             ///< PlacedMotion::row
    FloatPath states;                        ///< joined by free motions
    std::array<double, 2> weights = {1, 1};  ///< per tree; 0: appended once
  };

  void find_more();
  void adapt_share();
  [[nodiscard]] Motion* choose(std::size_t graph);
  void add_free_stretches(const PlacedMotion& placed);

  PlannerRun& run_;
  Rng rng_;
  bool is_more_left_;
  double trust_;                  ///< MotionSource::trust()
  std::uint64_t finding_ = 0;     ///< work of finding motions
  std::uint64_t found_with_ = 0;  ///< states checked to find them
  int misses_ = 0;                ///< calls in a row that found none
  double first_iteration_;
  std::vector<Motion> motions_;
  double share_ = 0;  ///< of iterations that append
};

}  // namespace mneme::internal
