// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Learning local samplers: by solving local queries of a primitive, offline over a grid of
/// primitives or on a miss.
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
#include "mneme/experience.h"
#include "mneme/primitive.h"
#include "mneme/planning.h"

namespace mneme {

struct LearnSettings {
  int starts_per_link = 3;
  int paths_per_start = 2;
  int max_iterations = 20000;
  double range = 0.4;
  double resolution = 0;
  bool merge_cliques = false;
};

template <class Settings, class Visitor>
requires std::same_as<std::remove_const_t<Settings>, LearnSettings>
void visit_settings(Settings& s, Visitor&& visit) {
  visit("starts-per-link", s.starts_per_link, 1, 1000,
        "local queries per link that can be in the gap; more make the sampler "
        "richer and slower to learn");
  visit("paths-per-start", s.paths_per_start, 1, 1000,
        "paths per local query: several are robust to obstacles outside the primitive");
  visit("learn-iterations", s.max_iterations, 1, 100000000,
        "iteration limit of one local query; a query that reaches it is given up");
  visit("learn-range", s.range, 1e-3, 1e3, "extension range of local queries, radians");
  visit("learn-resolution", s.resolution, 0.0, 1.0,
        "resolution of local queries, radians; 0 for the robot's default");
  visit("merge-cliques", s.merge_cliques, false, true,
        "merge fully connected groups of means into one component with their covariance: a smaller "
        "database");
}
/// The settings as one line of text, the same for equal settings: part of a row's provenance.
[[nodiscard]] std::string describe(const LearnSettings& settings);

struct LearnResult {
  LocalSampler sampler;  ///< canonical frame; no components if no query was solved
  int queries = 0;
  int solved = 0;
  std::uint64_t iterations = 0;
  double time_s = 0;
};

/// Section IV-A of the paper: solves queries that start with the arm threaded through the gap,
/// stratified by the first link that crosses it, and end with the arm wholly out; shortcuts the
/// paths and places one component at each waypoint; no mean is in contact. Depends on the arguments
/// alone if `deadline_s` is 0; otherwise it stops after that many seconds with what it has, and in
/// any case within a few milliseconds once `cancel` is set. Errors: a robot that it does not
/// handle; a key that is none of the decomposer "pairs".
[[nodiscard]] Result<LearnResult> learn_local_sampler(const Robot& robot, const PrimitiveKey& key,
                                                      const LearnSettings& settings,
                                                      std::uint64_t seed, double deadline_s = 0,
                                                      const std::atomic<bool>* cancel = nullptr);

/// A primitive and a scene of its obstacles alone, in its order.
struct LocalProblem {
  LocalPrimitive primitive;
  Scene scene;
  std::string kind;  ///< of the row that is learned: decomposer_version()
};
[[nodiscard]] std::vector<LocalProblem> local_problems(const Scene& scene,
                                                       std::span<const LocalPrimitive> primitives,
                                                       const std::string& kind);
/// The same for any arm. In space, queries start with the robot's body covering the middle of the
/// passage between the first two obstacles, stratified by the joint that carries the part that
/// does, last joint first, and end with the body clear of that middle. Two obstacles that touch, or
/// a passage out of reach, teach nothing.
[[nodiscard]] Result<LearnResult> learn_local_sampler(const Robot& robot,
                                                      const LocalProblem& problem,
                                                      const LearnSettings& settings,
                                                      std::uint64_t seed, double deadline_s = 0,
                                                      const std::atomic<bool>* cancel = nullptr);

/// Learns from what was solved: per primitive of the scene one row whose components are the
/// waypoints of `paths` that belong to it, moved to the canonical frame. A waypoint belongs to a
/// primitive if one shape of the robot that the symmetric joints move is closer than `reach`
/// (metres) to all obstacles of the primitive. Rows have no provenance yet; primitives without a
/// waypoint have none. O(waypoints * shapes * obstacles). Errors: those of decompose().
[[nodiscard]] Result<std::vector<Experience>> learn_from_paths(const Robot& robot,
                                                               const Scene& scene,
                                                               std::span<const Path> paths,
                                                               const DecomposeSettings& settings,
                                                               double reach = 0.12);

/// Remembers solved paths as a whole (decomposer "paths"): per path that is not empty one row whose
/// key is that of its ends and whose means are its waypoints, ends included, in their order.
/// create_gl_sampler() bends them to the ends of other queries.
[[nodiscard]] std::vector<Experience> learn_whole_paths(const Robot& robot,
                                                        std::span<const Path> paths);

/// Section V-A: greedily groups means that see each other along straight free motions, and replaces
/// each group by one component with the group's mean, and its covariance if it has more than
/// joint_count members. Components that have a factor already stay as they are, and groups whose
/// mean is in contact stay apart; members of a group count for the same origin.
[[nodiscard]] LocalSampler merge_cliques(const CollisionChecker& checker,
                                         const LocalSampler& sampler);

/// Random configurations of a planar arm that is threaded through the gap of a pair of circles,
/// free of contact. `first_link` (0-based) is the first link that crosses the segment between the
/// circles. Returns nothing if none was found in `attempts` tries.
[[nodiscard]] std::optional<Configuration> sample_threaded(const CollisionChecker& checker,
                                                           const PrimitiveKey& key, int first_link,
                                                           int attempts, Rng& rng);
/// The first link of a planar arm that crosses the segment between the two circles, or -1: then the
/// arm is out.
[[nodiscard]] int first_crossing_link(const Robot& robot, const PrimitiveKey& key,
                                      std::span<const double> q);

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
