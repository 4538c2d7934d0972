// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What solve() is asked, completed and checked once: all below trusts it.
#pragma once

#include "mneme/pipeline.h"

#include "pipeline/proven_motions.h"

#include <memory>
#include <vector>

namespace mneme::internal {

/// A kind of memory in a query, and the settings that count for it.
struct KindSettings {
  const MemoryKind* kind = nullptr;
  double lambda = 0;
  double least_lambda = 0;
  double sigma = 0;
  double similarity = 0;  ///< above 0, so that a key always matches itself
  int max_matches = 0;
  bool drop_invalid_means = false;
  bool retarget = false;
  int retrieve_after = 0;
  Widening widening;
  double max_gap = 0;
  double replay = 0;
};

/// What is asked of memory. Refers to the query and the database.
struct MemoryRequest {
  MemoryQuery query;
  Database* database = nullptr;     ///< null: there is no memory
  SolveSettings settings;           ///< in range
  std::vector<KindSettings> kinds;  ///< empty without a database
  Stopwatch stopwatch;              ///< of the call

  /// The time limit is reached, or the call is cancelled.
  [[nodiscard]] bool is_over() const;
};
/// Errors: a setting out of range; an unknown kind; a database of another robot; a budget for
/// learning that no kind can use.
[[nodiscard]] Result<MemoryRequest> make_memory_request(const MemoryQuery& query,
                                                        Database* database,
                                                        const SolveSettings& settings);

/// A problem to be solved. Refers to the problem and the database.
struct Query : MemoryRequest {
  const Problem& problem;
  PlanQuery ends;
  const PlannerEntry& planner;
  const SamplerEntry& sampler;
  CollisionChecker checker;
  std::vector<std::string> notes;              ///< for people, about the checker
  bool are_ends_clear = false;                 ///< of the checker, as it was made
  std::shared_ptr<StaticCell> cell = nullptr;  ///< the checker's, where tasks are replayed
};
/// The checker for a problem with these settings and `goals`, its own or others.
[[nodiscard]] Result<QueryChecker> make_query_checker(const Problem& problem,
                                                      const SolveSettings& settings,
                                                      const std::vector<Configuration>& goals);
/// Errors besides: an unknown planner or sampler, or two that do not go together; a budget for
/// learning with a sampler that does not ask memory; a scene that cannot be checked.
[[nodiscard]] Result<Query> make_query(const Problem& problem, Database* database,
                                       const SolveSettings& settings);

}  // namespace mneme::internal
