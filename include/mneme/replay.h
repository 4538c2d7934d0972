// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Known tasks: what became of the remembered paths that were tried instead of a search.
#pragma once

#include "mneme/base.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace mneme {

/// A remembered path that is in contact after it was deformed to lead from the query's start to its
/// goal.
struct BlockedPath {
  std::int64_t row = 0;  ///< id of the path's row in the database
  double distance = 0;   ///< of the path's ends from the query's, as in SolveSettings::replay
  double fraction = 0;   ///< share of the path's length before the first state in contact
  Configuration state;   ///< the first state in contact
};

/// Reports the replay of known tasks near a query: see SolveSettings::replay.
struct Replay {
  std::int64_t row = 0;      ///< id of the replayed path's row; 0: the path was planned.
  double distance = 0;       ///< of the replayed path's ends from the query's.
  bool is_repaired = false;  ///< parts of the path were replaced to avoid contact.
  std::vector<BlockedPath> blocked = {};  ///< paths that could not be used, nearest first.
  /// Distance of the nearest known task among the compared keys, if all were too far.
  std::optional<double> nearest = {};
  /// Row of the nearest path that was not checked, because planning it took less than its check
  /// would.
  std::optional<std::int64_t> cheap_row = {};
  std::uint64_t keys = 0;        ///< keys of known tasks that were compared
  std::uint64_t iterations = 0;  ///< of the searches that repaired paths
  std::uint64_t states = 0;      ///< checked by replay
  /// States that planning the replayed path took when it was stored; 0 if unknown or not replayed.
  std::uint64_t planning_states = 0;
  double time_s = 0;  ///< 0 if memory was not asked

  [[nodiscard]] bool is_hit() const { return row != 0; }
};

}  // namespace mneme
