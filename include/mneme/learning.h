// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Learning offline: from grids of primitives, from scenes and from solved problems.
#pragma once

#include "mneme/base.h"
#include "mneme/memory.h"
#include "mneme/problem.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mneme {

/// A range of canonical primitives (scenes/planar/grid.yaml).
struct PrimitiveGrid {
  std::array<double, 2> radius = {1, 2};    ///< of each circle, metres
  std::array<double, 2> gap = {0.1, 1};     ///< between the circles, metres
  std::array<double, 2> distance = {1, 9};  ///< from the base to the midpoint of the gap, metres
  /// Largest similarity error, m^2, of a primitive of the range to the nearest chosen primitive.
  double max_similarity_error = 3;
  int count = 0;  ///< least number of primitives to choose
};
[[nodiscard]] Result<PrimitiveGrid> load_grid(const std::string& path);

/// Samples a random canonical primitive of the grid's range; the base is outside both circles.
[[nodiscard]] PrimitiveKey sample_primitive(const PrimitiveGrid& grid, Rng& rng);
/// Chooses canonical primitives that cover the grid, each far from the previous ones: at least
/// `count`, then more until random primitives of the range are within `max_similarity_error` of a
/// chosen one. Deterministic; the first `count` primitives are also the first for any larger count.
/// Ends within a few milliseconds after `cancel` is set.
[[nodiscard]] std::vector<PrimitiveKey> cover(const PrimitiveGrid& grid, std::uint64_t seed,
                                              const std::atomic<bool>* cancel = nullptr);

/// Coverage of a grid by keys: similarity errors of random primitives of the range to their nearest
/// key.
struct Coverage {
  int probes = 0;
  /// Squared distances, m^2; infinite without keys or probes.
  double median = std::numeric_limits<double>::infinity();
  double p95 = std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};
[[nodiscard]] Coverage measure_coverage(const PrimitiveGrid& grid,
                                        std::span<const PrimitiveKey> keys, int probes,
                                        std::uint64_t seed);

struct LearnProgress {
  std::int64_t done = 0;  ///< requested primitives or problems that are finished
  std::int64_t total = 0;
  std::int64_t components = 0;  ///< learned in this run
  double elapsed_s = 0;
};

/// Settings common to all offline learning.
struct LearnRun {
  std::uint64_t seed = 1;
  int jobs = 1;  ///< threads
  /// Set by another thread to end the run within a few milliseconds. May be null.
  const std::atomic<bool>* cancel = nullptr;
  /// Called about once a second and at the end, from one thread.
  std::function<void(const LearnProgress&)> on_progress = {};
};

struct LearnSummary {
  std::int64_t learned = 0;  ///< Primitives or problems learned in this run.
  /// Primitives or problems already in the database with the same seed and settings, or learned by
  /// other processes that share the work.
  std::int64_t skipped = 0;
  std::int64_t empty = 0;  ///< Primitives or problems learned without any component.
  std::vector<std::string> unsolved = {};  ///< Problems without a path: "NAME: not solved: REASON".
  std::int64_t rows = 0;
  std::int64_t components = 0;
  bool is_cancelled = false;
  double time_s = 0;
};

/// Lets several processes share the primitives of a job.
struct SharedWork {
  std::string url;  ///< the job's database; must be on a PostgreSQL server
  /// Seconds after which other processes take over the primitives of a process that no longer
  /// renews its lease, 0.1 to 86400.
  double lease_s = 30;
};

struct LearnJob : LearnRun {
  LearnSettings settings = {};
  std::optional<SharedWork> shared = {};
};

/// Learns the primitives `keys` in parallel and inserts the rows into `database` during the run, in
/// key order. A killed job continues when it is run again. The database's contents do not depend on
/// `jobs`. With `shared`, any number of processes with equal arguments learn each primitive once
/// between them, in any order, even if some are killed; each returns when all primitives are
/// learned. A lost connection is retried for the duration of a lease. Errors: unsupported if
/// `shared` and the database is not on a PostgreSQL server; those of Database::insert().
[[nodiscard]] Result<LearnSummary> learn_primitives(const Robot& robot,
                                                    std::span<const PrimitiveKey> keys,
                                                    Database& database, const LearnJob& job);

/// Settings for learning from problems, each solved several times.
struct ProblemLesson : LearnRun {
  int paths = 5;                              ///< per problem
  double timeout_s = 10;                      ///< per path, 0 to 1e6
  std::optional<double> walk = std::nullopt;  ///< PlanSettings::walk
};

struct RepeatedPlan {
  std::vector<Path> paths;
  std::string message = {};  ///< reason of the last run without a path
};
/// Solves the problem `lesson.paths` times with rrt_connect and uniform samples, each time with
/// another seed. Errors: those of CollisionChecker::make(); invalid for a time limit out of range.
[[nodiscard]] Result<RepeatedPlan> solve_repeatedly(const Problem& problem,
                                                    const ProblemLesson& lesson);

/// Solves each problem several times and inserts the rows of learn_from_paths(), in the order of
/// the problems, each problem's rows in one transaction. An interrupted call continues when it is
/// repeated: equal problems learned with the same kind, `max_gap`, number of paths and seed are
/// skipped, except those that taught no row, of which the database has no record. All problems must
/// be of the database's robot. Errors: those of solve_repeatedly(), learn_from_paths(),
/// Database::insert().
[[nodiscard]] Result<LearnSummary> learn_from_problems(std::span<const Problem> problems,
                                                       const MemorySettings& memory,
                                                       Database& database,
                                                       const ProblemLesson& lesson);

}  // namespace mneme
