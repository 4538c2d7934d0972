// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Learning offline: lessons from grids of primitives, from scenes and from solved problems.
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
  double max_similarity_error =
      3;          ///< every primitive of the range shall have a match closer than this, m^2
  int count = 0;  ///< at least this many primitives
};
[[nodiscard]] Result<PrimitiveGrid> load_grid(const std::string& path);

/// Draws a random primitive of the grid's range, canonical; the base lies in neither circle.
[[nodiscard]] PrimitiveKey sample_primitive(const PrimitiveGrid& grid, Rng& rng);
/// A sequence of canonical primitives that covers the grid, each far from those before it; ends
/// when `count` is reached and random primitives of the range keep finding a match. The same
/// arguments give the same sequence. Its first `count` primitives are also the first of any larger
/// count; those that come after them to complete the cover are not. Ends early, within a few
/// milliseconds, once `cancel` is set.
[[nodiscard]] std::vector<PrimitiveKey> cover(const PrimitiveGrid& grid, std::uint64_t seed,
                                              const std::atomic<bool>* cancel = nullptr);

/// How well keys cover a grid: the similarity error of random primitives of the range to their
/// nearest key.
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
  std::int64_t done = 0;  ///< of those asked for: primitives in the database, or problems
  std::int64_t total = 0;
  std::int64_t components = 0;  ///< learned now
  double elapsed_s = 0;
};

/// How lessons of any kind are run.
struct LearnRun {
  std::uint64_t seed = 1;
  int jobs = 1;  ///< threads
  /// Set by another thread to end the run within a few milliseconds; may be null.
  const std::atomic<bool>* cancel = nullptr;
  /// Called about once a second and at the end, from one thread.
  std::function<void(const LearnProgress&)> on_progress;
};

struct LearnSummary {
  std::int64_t learned = 0;  ///< primitives, or problems, learned now
  std::int64_t skipped = 0;  ///< already in the database with the same seed and settings, or shared
                             ///< work that other processes did
  std::int64_t empty = 0;    ///< of those learned: without a component
  std::vector<std::string> unsolved;  ///< problems without a path, and why: "NAME: not solved: ..."
  std::int64_t rows = 0;
  std::int64_t components = 0;
  bool is_cancelled = false;
  double time_s = 0;
};

/// What makes a process one of several that share a job's primitives as they go.
struct SharedWork {
  std::string url;  ///< of the job's database, which must be on a PostgreSQL server
  /// Seconds without a sign of life after which a process's primitives go to others, 0.1 to 86400.
  double lease_s = 30;
};

struct LearnJob : LearnRun {
  LearnSettings settings;
  std::optional<SharedWork> shared;
};

/// Learns `keys` into `database`, in parallel; rows are inserted as they come, in key order, so
/// that a job that is killed can be run again and goes on where it was. The database's contents do
/// not depend on `jobs`. With `shared`, any number of processes that are given the same arguments
/// learn each primitive once between them, in any order, whichever of them are killed on the way;
/// each returns when all primitives are learned. A lost connection is made again for as long as a
/// lease lasts. Errors: unsupported if the database is not on a PostgreSQL server; those of
/// Database::insert().
[[nodiscard]] Result<LearnSummary> learn_primitives(const Robot& robot,
                                                    std::span<const PrimitiveKey> keys,
                                                    Database& database, const LearnJob& job);

/// Lessons from problems that are solved for the purpose.
struct ProblemLesson : LearnRun {
  int paths = 5;          ///< per problem
  double timeout_s = 10;  ///< per path, 0 to 1e6
};

struct RepeatedPlan {
  std::vector<Path> paths;
  std::string message;  ///< why the last run without a path has none
};
/// Solves the problem `lesson.paths` times with rrt_connect and uniform samples, each time with
/// another seed. Errors: those of CollisionChecker::make(); a time limit out of range.
[[nodiscard]] Result<RepeatedPlan> solve_repeatedly(const Problem& problem,
                                                    const ProblemLesson& lesson);

/// Solves each problem several times and inserts what its paths teach, as learn_from_paths() says,
/// in the order of the problems and the rows of each in one transaction, so that a lesson that was
/// ended goes on where it was. A problem is skipped if the very same, by the same name, has taught
/// this kind of memory something with the same `max_gap`, number of paths and seed. All are of the
/// database's robot. Errors: those of solve_repeatedly(), learn_from_paths(), Database::insert().
[[nodiscard]] Result<LearnSummary> learn_from_problems(std::span<const Problem> problems,
                                                       const MemorySettings& memory,
                                                       Database& database,
                                                       const ProblemLesson& lesson);

}  // namespace mneme
