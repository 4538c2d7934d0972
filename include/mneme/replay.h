// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Known tasks: what became of the remembered paths that were tried before any search.
#pragma once

#include "mneme/base.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace mneme {

/// A remembered path that is in contact after it was fitted to start and goal of the query.
struct BlockedPath {
  std::int64_t row = 0;  ///< of the database
  double distance = 0;   ///< from its ends to the query's, as in SolveSettings::replay
  double fraction = 0;   ///< share of its length before the first state in contact
  Configuration state;   ///< the first state in contact
};

/// Reports the replay of known tasks near a query: see SolveSettings::replay.
struct Replay {
  std::int64_t row = 0;              ///< row of the replayed path; 0: the path was planned.
  double distance = 0;               ///< from its ends to the query's.
  bool is_repaired = false;          ///< True if parts of it were replaced to avoid contact.
  std::vector<BlockedPath> blocked;  ///< paths that could not be used, nearest first.
  /// Distance of the nearest known task among the compared keys, if all were too far.
  std::optional<double> nearest;
  std::uint64_t keys = 0;        ///< keys of known tasks that were compared
  std::uint64_t iterations = 0;  ///< of searches that repaired a path
  double time_s = 0;             ///< 0 if there was no memory to query

  [[nodiscard]] bool is_hit() const { return row != 0; }
};

}  // namespace mneme
