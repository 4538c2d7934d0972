// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The input of solve(), completed and checked once.
#pragma once

#include "mneme/pipeline.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace mneme::internal {

/// A kind of memory in a query, and the settings that apply to it.
struct KindSettings {
  const MemoryKind* kind = nullptr;
  double lambda = 0;
  double least_lambda = 0;
  double sigma = 0;
  MatchLimits matches;  ///< similarity above 0, so that a key always matches itself
  bool drop_invalid_means = false;
  bool retarget = false;
  int retrieve_after = 0;
  Widening widening;
  double max_gap = 0;
  double replay = 0;
};

/// The settings of a checker for a query with these settings and constraints.
[[nodiscard]] CheckerSettings checker_settings_of(
    const SolveSettings& settings, const std::vector<OrientationConstraint>& constraints = {});

/// Iterations of a search before anything dearer begins: asking memory, or other threads.
inline constexpr std::uint64_t kAlone = 64;

/// Problem, database and settings. Immutable; refers to problem, database, planner and sampler.
struct Query {
  const Problem& problem;
  Database* database = nullptr;  ///< null: memory is not queried
  SolveSettings settings;        ///< checked: all values are in range
  const PlannerEntry& planner;
  const SamplerEntry& sampler;
  std::vector<KindSettings> kinds;  ///< empty without a database
  /// Measures the time limit. Started by make_query(), and again once the scene is prepared.
  mutable Stopwatch stopwatch = {};
  /// Iterations of the search before memory is asked for a known task. Empty: it is asked before
  /// the search, because the settings name the distance of replay, or because the planner is slow
  /// to begin. 0: after the straight motion. Otherwise kAlone: most tasks are planned by then, and
  /// neither ask nor fill the memory.
  std::optional<std::uint64_t> ask_after = {};
  /// Searches in vain are remembered, and answer; false if the settings forbid known answers.
  bool knows_vain_searches = false;

  /// The kind whose paths are replayed; null without one.
  [[nodiscard]] const KindSettings* replayed_kind() const;
  /// Only a query that may change the memory changes how later ones are planned.
  [[nodiscard]] bool may_change_memory() const {
    return database != nullptr && settings.remember_after.has_value();
  }
  [[nodiscard]] CheckerSettings checker_settings() const {
    return checker_settings_of(settings, problem.constraints);
  }
  /// True once the time limit is reached or the call is cancelled.
  [[nodiscard]] bool is_over() const;
  /// Seconds left of the time limit, at least 0.
  [[nodiscard]] double remaining_s() const;
};

/// Completes and checks a query. Errors: those of check_settings(); a planner that cannot keep the
/// problem's constraints; a database of another robot; a budget for learning that nothing can use.
[[nodiscard]] Result<Query> make_query(const Problem& problem, Database* database,
                                       const SolveSettings& settings);

}  // namespace mneme::internal
