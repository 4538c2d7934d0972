// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Learning offline: lessons from grids of primitives, from scenes and from solved problems.
#pragma once

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

#include "mneme/base.h"
#include "mneme/memory.h"

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
  std::int64_t done = 0;  ///< primitives in the database, of those asked for
  std::int64_t total = 0;
  std::int64_t components = 0;
  double elapsed_s = 0;
};

/// What makes a process one of several that share a job's primitives as they go.
struct SharedWork {
  std::string url;  ///< of the job's database, which must be on a PostgreSQL server
  /// Seconds without a sign of life after which a process's primitives go to others, 0.1 to 86400.
  double lease_s = 30;
};

struct LearnJob {
  LearnSettings settings;
  std::uint64_t seed = 1;
  int jobs = 1;  ///< threads
  const std::atomic<bool>* cancel = nullptr;
  std::function<void(const LearnProgress&)>
      on_progress;  ///< called about once a second, from one thread
  std::optional<SharedWork> shared;
};

struct LearnSummary {
  std::int64_t learned = 0;  ///< primitives learned now
  std::int64_t skipped = 0;  ///< already in the database with the same seed and settings, or shared
                             ///< work that other processes did
  std::int64_t empty = 0;    ///< of those learned: no query was solved
  std::int64_t components = 0;
  bool is_cancelled = false;
  double time_s = 0;
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

/// The same for primitives of any shapes, each in a scene of its own.
[[nodiscard]] Result<LearnSummary> learn_primitives(const Robot& robot,
                                                    std::span<const LocalProblem> problems,
                                                    Database& database, const LearnJob& job);

}  // namespace mneme
