// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The kinds of memory: ways to cut a query into primitives, to remember what passes each, and to
/// make samples of that for another query.
#pragma once

#include "mneme/base.h"
#include "mneme/check.h"
#include "mneme/experience.h"
#include "mneme/planning.h"
#include "mneme/primitive.h"

#include <array>
#include <atomic>
#include <concepts>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace mneme {

// Learning a local sampler.

struct LearnSettings {
  int starts_per_link = 3;
  int paths_per_start = 2;
  int max_iterations = 20000;
  double range = 0.4;
  std::optional<double> resolution;
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
  visit("learn-resolution", s.resolution, 1e-4, 1.0,
        "resolution of local queries, radians; left out, the robot's default");
  visit("merge-cliques", s.merge_cliques, false, true,
        "merge fully connected groups of means into one component with their covariance: a smaller "
        "database");
}
/// The settings as one line of text, the same for equal settings: part of a row's provenance.
[[nodiscard]] std::string describe(const LearnSettings& settings);

struct LearnResult {
  LocalSampler sampler;          ///< canonical frame; no components if no query was solved
  int queries = 0;               ///< local ones that were planned for
  int solved = 0;                ///< of these
  std::uint64_t iterations = 0;  ///< of all
  double time_s = 0;
};

/// A primitive and a scene of its obstacles alone, in its order.
struct LocalProblem {
  LocalPrimitive primitive;
  Scene scene;
};
[[nodiscard]] std::vector<LocalProblem> local_problems(const Scene& scene,
                                                       std::span<const LocalPrimitive> primitives);

// Kinds of memory.

/// What memory is asked about. Refers to all of it.
struct MemoryQuery {
  Robot robot;  ///< without what it carries: experience is of the robot itself
  const Scene& scene;
  const Configuration* start = nullptr;  ///< null if only the scene is known
  std::span<const Configuration> goals = {};
  std::span<const OrientationConstraint> constraints = {};
};

/// A stored experience that is similar to a primitive.
struct Match {
  std::shared_ptr<const Experience> experience;  ///< never null
  double similarity_error = 0;  ///< squared distance of the keys: m^2, for whole paths rad^2
  Symmetry to_scene;            ///< takes the stored means to the query's scene
};

/// A primitive of the query and what the memory knew of it.
struct PrimitiveRetrieval {
  LocalPrimitive primitive;
  std::vector<Match> matches;  ///< nearest first
  bool is_learned = false;     ///< there was no match, and it was learned just now
};

/// When a memory is asked, and how often it is drawn from.
struct MemoryShare {
  double lambda = 0.5;
  std::optional<double> least_lambda = std::nullopt;  ///< left out: lambda stays
  int retrieve_after = 0;
};

/// What measures best for the samplers of one kind; SolveSettings says what each means.
struct MemoryDefaults {
  MemoryShare share = {};
  /// For a planner that goes on escape walks, which need no memory for what is easy; left out:
  /// share.
  std::optional<MemoryShare> share_beside_walks = std::nullopt;
  double sigma = 0.1;
  double similarity = 1;
  int max_matches = 8;
  bool drop_invalid_means = true;
  bool retarget = false;
  double first_components = 1e9;
  double max_gap = 1;
};

/// One way to remember. To add one: src/memory/NAME.cpp, a row in src/memory/memory_kinds.cpp, a
/// test; command line, Python and benchmark take it from there. Functions are parallel-safe; those
/// that need a start and goals refuse a query without.
struct MemoryKind {
  std::string_view name;
  /// Name and number, such as "pairs/1". Changes whenever keys or means change their meaning: then
  /// rows of the other version are left alone instead of misread.
  std::string_view version;
  std::string_view summary;
  MemoryDefaults defaults;
  /// Numbers in a key.
  int (*key_size)(const Robot& robot) = nullptr;
  /// Algorithm 2, line 1: cuts a query into primitives. `max_gap`: two obstacles at most this far
  /// apart (metres, between surfaces) form a primitive. Errors: a robot or obstacles that it does
  /// not handle.
  Result<std::vector<LocalPrimitive>> (*decompose)(const MemoryQuery& query,
                                                   double max_gap) = nullptr;
  /// All images of a canonical key, that key first.
  std::vector<KeyImage> (*images)(const PrimitiveKey& canonical) = nullptr;
  /// Algorithm 2, line 10: what matched becomes components for this query, in order of relevance.
  /// Component i counts for the retrieval whose index its source is.
  GaussianMixture (*synthesize)(const MemoryQuery& query,
                                std::span<const PrimitiveRetrieval> retrievals) = nullptr;
  /// The same with means that are fitted to the query's primitives, each when it is first drawn; a
  /// match is a group of components, the most relevant first. Origins are counted from
  /// `first_source`. Null, or returns null, where synthesize() is the only way.
  std::shared_ptr<const ComponentSource> (*retarget)(const MemoryQuery& query,
                                                     std::span<const PrimitiveRetrieval> retrievals,
                                                     SampleSource first_source) = nullptr;
  /// The path that a row remembers, bent so that it leads from the query's start to `goal`; empty
  /// if it remembers none. Null for a kind that does not keep whole paths.
  Path (*bend)(const MemoryQuery& query, const Configuration& goal,
               const Experience& row) = nullptr;
  /// What solved paths of the query teach: rows with kind, key and sampler. Errors: those of
  /// decompose.
  Result<std::vector<Experience>> (*learn_from_paths)(const MemoryQuery& query,
                                                      std::span<const Path> paths, double max_gap,
                                                      double reach) = nullptr;
  /// Learns a primitive by solving local queries; see learn_local_sampler(). Null for a kind that
  /// learns from solved paths alone.
  Result<LearnResult> (*learn)(const Robot& robot, const LocalProblem& problem,
                               const LearnSettings& settings, std::uint64_t seed, double deadline_s,
                               const std::atomic<bool>* cancel) = nullptr;
  /// Why it does not learn on a miss; empty if it does.
  std::string_view no_learning_on_a_miss;
};

/// All kinds; the first one is the paper's.
[[nodiscard]] std::span<const MemoryKind* const> memory_kinds();
/// Error: an unknown name; the message lists those there are.
[[nodiscard]] Result<const MemoryKind*> find_memory_kind(std::string_view name);
/// The kind of rows of this version; null if this mneme has none.
[[nodiscard]] const MemoryKind* memory_kind_of(std::string_view version);
/// The kind that learns primitives of a robot: "pairs" for planar arms, otherwise "body_pairs".
[[nodiscard]] const MemoryKind& default_memory_kind(const Robot& robot);
/// The kind that solved problems teach a robot most as: "paths" for arms in space.
[[nodiscard]] const MemoryKind& default_kind_of_paths(const Robot& robot);

/// Which memory, and how a scene is cut into its primitives.
struct MemorySettings {
  std::optional<std::string> kind;  ///< one of memory_kinds(); left out, see where it is used
  std::optional<double> max_gap;
};

template <class Settings, class Visitor>
requires std::same_as<std::remove_const_t<Settings>, MemorySettings>
void visit_settings(Settings& s, Visitor&& visit) {
  visit("max-gap", s.max_gap, 0.0, 1e6,
        "two obstacles at most this far apart (metres, between surfaces) form a primitive; left "
        "out, the default of the kind of memory (1 for pairs, 0.25 for body_pairs and gaps)");
}

/// The kind that the settings name, or else default_memory_kind().
[[nodiscard]] Result<const MemoryKind*> choose_kind(const Robot& robot,
                                                    const MemorySettings& settings);
/// Cuts a query into primitives of the kind that choose_kind() says.
[[nodiscard]] Result<std::vector<LocalPrimitive>> decompose(const MemoryQuery& query,
                                                            const MemorySettings& settings = {});
/// What solved paths teach the kind that choose_kind() says: of pairs of obstacles one row per
/// primitive, whose components are the waypoints that belong to it, moved to the canonical frame. A
/// waypoint belongs to a primitive if one shape of the robot that the symmetric joints move is
/// closer than `reach` (metres) to all its obstacles. Rows have no provenance yet; primitives
/// without a waypoint have none. O(waypoints * shapes * obstacles). Error: constraints, of a kind
/// that does not keep whole paths.
[[nodiscard]] Result<std::vector<Experience>> learn_from_paths(const MemoryQuery& query,
                                                               std::span<const Path> paths,
                                                               const MemorySettings& settings = {},
                                                               double reach = 0.12);

/// The stored experience of the kind whose similarity error to `primitive` is less than
/// `threshold`, nearest first, at most `max_matches` (0: all) and among so many keys as `keys_left`
/// allows. Errors: those of Database::find().
[[nodiscard]] Result<std::vector<Match>> find_matches(const Database& database,
                                                      const MemoryKind& kind,
                                                      const LocalPrimitive& primitive,
                                                      double threshold, int max_matches,
                                                      std::int64_t* keys_left = nullptr);

/// The paper's similarity error: squared Euclidean distance of two canonical keys of one kind, the
/// least over the images of one of them. m^2, for whole paths rad^2.
[[nodiscard]] double similarity_error(const MemoryKind& kind, const PrimitiveKey& a,
                                      const PrimitiveKey& b);

// The kind "pairs": two circles (x_a, y_a, r_a, x_b, y_b, r_b), metres, as in the paper. For planar
// arms; pairs that overlap or that the arm cannot reach are left out.

/// Brings a pair of circles to canonical form.
[[nodiscard]] LocalPrimitive make_primitive(const PrimitiveKey& circles);
/// The two circles of a key as a scene of their own.
[[nodiscard]] Scene make_scene(const PrimitiveKey& key);

/// Section IV-A of the paper: solves queries that start with the arm threaded through the gap,
/// stratified by the first link that crosses it, and end with the arm wholly out; shortcuts the
/// paths and places one component at each waypoint; no mean is in contact. Depends on the arguments
/// alone if `deadline_s` is 0; otherwise it stops after that many seconds with what it has, and in
/// any case within a few milliseconds once `cancel` is set. Errors: a robot that it does not
/// handle; a key that is none of the kind "pairs".
[[nodiscard]] Result<LearnResult> learn_local_sampler(const Robot& robot, const PrimitiveKey& key,
                                                      const LearnSettings& settings,
                                                      std::uint64_t seed, double deadline_s = 0,
                                                      const std::atomic<bool>* cancel = nullptr);
/// The same for any arm. In space, queries start with the robot's body covering the middle of the
/// passage between the first two obstacles, stratified by the joint that carries the part that
/// does, last joint first, and end with the body clear of that middle. Two obstacles that touch, or
/// a passage out of reach, teach nothing.
[[nodiscard]] Result<LearnResult> learn_local_sampler(const Robot& robot,
                                                      const LocalProblem& problem,
                                                      const LearnSettings& settings,
                                                      std::uint64_t seed, double deadline_s = 0,
                                                      const std::atomic<bool>* cancel = nullptr);

/// Section V-A: greedily groups means that see each other along straight free motions, and replaces
/// each group by one component with the group's mean, and its covariance if it has more than
/// joint_count members. Components that have a factor already stay as they are, and groups whose
/// mean is in contact stay apart; members of a group count for the same source.
[[nodiscard]] LocalSampler merge_cliques(const CollisionChecker& checker,
                                         const LocalSampler& sampler);

// The kind "body_pairs": two obstacles of any shapes, touching ones too.

/// Numbers of one obstacle in a key of the kind "body_pairs".
inline constexpr int kBodyKeySize = 9;
/// An obstacle as numbers, all in metres and all alike under the Euclidean norm, whatever its
/// shapes: its centroid c (x, y, z), then the square root S of three times the covariance of its
/// volume (xx, yy, zz, and sqrt(2) times xy, xz, yz). S of a box with half extents h and rotation R
/// is R diag(h) R^T, so that no order or sign of its axes matters; a cylinder has sqrt(3)/2 of its
/// radius and half its length, a sphere sqrt(3/5) of its radius. Shapes of one obstacle are summed
/// by volume.
[[nodiscard]] std::array<double, kBodyKeySize> body_key(const Obstacle& obstacle);
/// Brings a pair of bodies to canonical form.
[[nodiscard]] LocalPrimitive make_body_primitive(const SymmetricJoints& joints, const Obstacle& a,
                                                 const Obstacle& b);

// The kind "gaps": pairs of any shapes that leave a passage for the thinnest part of the robot,
// with the obstacles that bound it: those that a ray from its middle, at right angles to the line
// between the pair, meets first, within kGapReach.

/// Numbers in a key of the kind "gaps": the middle of the passage and 3 x 3 x 3 distances.
inline constexpr int kGapKeySize = 30;
inline constexpr double kGapReach = 0.25;        ///< metres from the middle that matter to a gap
inline constexpr double kGapProbeSpacing = 0.1;  ///< metres between the points of gap_key()
/// The place and the surroundings of a passage as numbers, all in metres and alike under the
/// Euclidean norm: its middle, then a third of the distances, each at most kGapReach, from the
/// points of a grid around the middle to the nearest obstacle (0 inside one). The grid has the axes
/// of `rotation` and kGapProbeSpacing; its last axis counts fastest. Whatever the obstacles'
/// shapes, number and order, surfaces that move by less than e change the distances' share of the
/// norm by less than sqrt(3) e; what is out of reach changes nothing, so that keys of unlike
/// shelves agree where their passages do.
[[nodiscard]] PrimitiveKey gap_key(std::span<const Obstacle> obstacles, const Vec3& middle,
                                   const Eigen::Matrix3d& rotation);

// The kind "paths": whole solved paths, found by their ends and bent to those of the query.

/// A whole query as a primitive of the kind "paths": its key holds both
/// configurations, a continuous joint as its cosine and sine, and before them the distance between
/// these two rows. Constraints that are kept all the way add a multiple of 1000 to that, which
/// keeps queries with different ones apart: the multiple derives from their numbers, and is one of
/// 900. The two images are the query and its reverse; no obstacles count.
[[nodiscard]] LocalPrimitive make_query_primitive(
    const Robot& robot, std::span<const double> start, std::span<const double> goal,
    std::span<const OrientationConstraint> constraints = {});
/// Numbers in such a key.
[[nodiscard]] int query_key_size(const Robot& robot);

}  // namespace mneme
