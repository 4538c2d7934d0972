// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Known tasks: what became of the remembered paths that were tried before any search.
#pragma once

#include "mneme/base.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace mneme {

/// A remembered path that is in contact once it is bent to the query's ends.
struct BlockedPath {
  std::int64_t row = 0;  ///< of the database
  double distance = 0;   ///< from its ends to the query's, as SolveSettings::replay
  double fraction = 0;   ///< share of its length before the first state in contact
  Configuration state;   ///< that state
};

/// The result of trying the known tasks near a query: see SolveSettings::replay.
struct Replay {
  std::int64_t row = 0;              ///< row whose path the plan is; 0: none, the path was planned
  double distance = 0;               ///< from its ends to the query's
  bool is_repaired = false;          ///< parts of it lead round new contacts
  std::vector<BlockedPath> blocked;  ///< paths that were tried in vain, nearest first
  /// Distance of the nearest known task that was seen, if none was near enough to be tried.
  std::optional<double> nearest;
  std::uint64_t keys = 0;        ///< keys of known tasks that were compared
  std::uint64_t iterations = 0;  ///< of the searches that repaired a path
  double time_s = 0;             ///< 0 if there was no memory to query

  [[nodiscard]] bool is_hit() const { return row != 0; }
};

}  // namespace mneme
