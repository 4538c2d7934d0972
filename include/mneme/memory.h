// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Kinds of memory: each cuts a query into local primitives, remembers configurations for a
/// primitive, and turns what it remembers into samples for another query.
#pragma once

#include "mneme/base.h"
#include "mneme/check.h"
#include "mneme/experience.h"
#include "mneme/planning.h"
#include "mneme/robot.h"
#include "mneme/scene.h"

#include <array>
#include <atomic>
#include <concepts>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace mneme {

// Primitives: the pieces of a workspace that experience is bound to.

/// The numbers that describe a primitive, in the robot's base frame. Their meaning depends on the
/// kind of memory.
using PrimitiveKey = std::vector<double>;

/// A motion of the workspace that a motion of the leading joints undoes: first the mirror image
/// y -> -y (which negates all joints of a planar arm), then a rotation about the axis of the
/// turning joint and a shift along it.
struct Symmetry {
  double rotation = 0;  ///< radians
  bool is_mirrored = false;
  double lift = 0;  ///< metres along z
};
/// The motion that undoes `motion`.
[[nodiscard]] Symmetry inverse(const Symmetry& motion);
/// `first`, then `second`, as one motion.
[[nodiscard]] Symmetry compose(const Symmetry& second, const Symmetry& first);

/// The leading joints of a robot that move all the rest of it rigidly. No symmetry moves the links
/// before them, such as a base or a head.
struct SymmetricJoints {
  int turn = -1;                  ///< index into a configuration of the joint about z, or -1
  int lift = -1;                  ///< index of the prismatic joint along z, or -1
  double axis_x = 0, axis_y = 0;  ///< where the axis of `turn` meets the plane z = 0, metres
};
/// Finds them along the chain from the root: a prismatic joint along the root's z and a revolute or
/// continuous one about it, in either order, that carry all further joints of the group. A planar
/// arm has joint 1; Fetch has torso lift and shoulder pan. O(links).
[[nodiscard]] SymmetricJoints find_symmetric_joints(const Robot& robot);

/// The configuration whose moving links are those of `q`, moved by `motion`. The turning joint is
/// wrapped to [-pi, pi); the caller checks limits.
[[nodiscard]] Configuration moved_configuration(const SymmetricJoints& joints,
                                                const Symmetry& motion, std::span<const double> q);
/// The pair of circles `key`, moved by `motion`.
[[nodiscard]] PrimitiveKey moved_key(const Symmetry& motion, const PrimitiveKey& key);

/// A local primitive lw_i of a query.
struct LocalPrimitive {
  std::vector<int> obstacles;   ///< indices into the scene; into make_scene(key) if it came from
                                ///< make_primitive()
  std::string kind;             ///< MemoryKind::version of the kind that the key belongs to
  PrimitiveKey key;             ///< canonical: the midpoint of the two centres lies on the positive
                                ///< x axis (seen from the axis of the turning joint) and, with a
                                ///< lift, at z = 0
  Symmetry to_scene;            ///< takes the canonical primitive to the scene
  double gap = 0;               ///< metres between the two obstacles
  bool is_whole_query = false;  ///< a start and a goal without obstacles (kind "paths")
  std::uint64_t constraints = 0;  ///< hash of those that a whole path has to keep; 0: none
};

/// One of several keys that describe the same canonical primitive, such as the other order of a
/// pair. A lookup queries all of them, because one choice would jump where two are nearly equal.
struct KeyImage {
  PrimitiveKey key;
  bool is_mirrored = false;
};

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
        "Local queries per link that can be in the gap. More make the sampler richer and slower to "
        "learn.");
  visit("paths-per-start", s.paths_per_start, 1, 1000,
        "Paths per local query. More make the sampler robust to obstacles outside the primitive.");
  visit("learn-iterations", s.max_iterations, 1, 100000000,
        "Iteration limit of one local query. A query that reaches it teaches nothing.");
  visit("learn-range", s.range, 1e-3, 1e3, "Extension range of local queries, radians.");
  visit("learn-resolution", s.resolution, 1e-4, 1.0,
        "Resolution of local queries, radians. Default: the robot's.");
  visit("merge-cliques", s.merge_cliques, false, true,
        "Merge groups of means that see each other into one component with their covariance "
        "(section V-A of the paper). Makes a smaller database.");
}
/// The settings as one line of text, the same for equal settings: part of a row's provenance.
[[nodiscard]] std::string describe(const LearnSettings& settings);

struct LearnResult {
  LocalSampler sampler;          ///< canonical frame; no components if no query was solved
  int queries = 0;               ///< local queries that were planned for
  int solved = 0;                ///< local queries with a path
  std::uint64_t iterations = 0;  ///< over all local queries
  double time_s = 0;
};

// Kinds of memory.

/// A query to memory. Refers to its arguments.
struct MemoryQuery {
  Robot robot;  ///< without attached objects: experience belongs to the robot itself
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

/// A primitive of the query and its matches in memory.
struct PrimitiveRetrieval {
  LocalPrimitive primitive;
  std::vector<Match> matches;  ///< nearest first
  bool is_learned = false;     ///< learned during this query, because nothing matched
};

/// When a memory is queried, and how often it is sampled.
struct MemoryShare {
  double lambda = 0.5;
  std::optional<double> least_lambda = std::nullopt;  ///< none: lambda is constant
  int retrieve_after = 0;
};

/// The values that measure best for one kind. SolveSettings and MemorySettings explain each.
struct MemoryDefaults {
  MemoryShare share = {};
  /// For planners with escape walks, which solve easy problems without memory. None: `share`.
  std::optional<MemoryShare> share_with_walks = std::nullopt;
  double sigma = 0.1;
  double similarity = 1;
  int max_matches = 8;
  bool drop_invalid_means = true;
  bool retarget = false;
  double first_components = 1e9;
  double max_gap = 1;

  [[nodiscard]] const MemoryShare& share_for(bool walks) const {
    return walks && share_with_walks ? *share_with_walks : share;
  }
};

/// One way to remember. To add one: src/memory/NAME.cpp with a test, and its name in
/// src/memory/memory_kinds.cpp. Command line, Python, benchmarks and documents take it from there.
/// Functions are parallel-safe; those that need a start and goals refuse a query without.
struct MemoryKind {
  std::string_view name;
  /// Name and number, such as "pairs/1". Changes whenever keys or means change their meaning; rows
  /// of another version are ignored.
  std::string_view version;
  std::string_view summary;
  MemoryDefaults defaults;
  /// True if the kind can remember something for the robot.
  bool (*handles)(const Robot& robot) = nullptr;
  /// The kind of highest rank that handles a robot is the default for primitives of scenes, and for
  /// solved problems.
  int rank_for_scenes = 0, rank_for_paths = 0;
  /// Numbers in a key.
  int (*key_size)(const Robot& robot) = nullptr;
  /// Algorithm 2, line 1: cuts a query into primitives. `max_gap`: two obstacles at most this far
  /// apart (metres, between surfaces) form a primitive. Errors: a robot or obstacles that the kind
  /// does not handle.
  Result<std::vector<LocalPrimitive>> (*decompose)(const MemoryQuery& query,
                                                   double max_gap) = nullptr;
  /// All images of a canonical key, that key first.
  std::vector<KeyImage> (*images)(const PrimitiveKey& canonical) = nullptr;
  /// Algorithm 2, line 10: turns matches into components for this query, in order of relevance. The
  /// source of a component is the index of its retrieval.
  GaussianMixture (*synthesize)(const MemoryQuery& query,
                                std::span<const PrimitiveRetrieval> retrievals) = nullptr;
  /// The same with means that are fitted to the query's primitives, each when it is first sampled;
  /// a match is a group of components, the most relevant first. Sources are counted from
  /// `first_source`. Null, or returns null, where synthesize() is the only way.
  std::shared_ptr<const ComponentSource> (*retarget)(const MemoryQuery& query,
                                                     std::span<const PrimitiveRetrieval> retrievals,
                                                     SampleSource first_source) = nullptr;
  /// The path that a row remembers, bent so that it leads from the query's start to `goal`; empty
  /// if the row has none. Null for a kind that does not keep whole paths.
  Path (*bend)(const MemoryQuery& query, const Configuration& goal,
               const Experience& row) = nullptr;
  /// Turns solved paths of the query into rows with kind, key and sampler. Errors: those of
  /// decompose.
  Result<std::vector<Experience>> (*learn_from_paths)(const MemoryQuery& query,
                                                      std::span<const Path> paths, double max_gap,
                                                      double reach) = nullptr;
  /// Learns a primitive from its key by solving local queries; see learn_local_sampler(). Null for
  /// a kind that learns from solved paths alone.
  Result<LearnResult> (*learn)(const Robot& robot, const PrimitiveKey& key,
                               const LearnSettings& settings, std::uint64_t seed, double deadline_s,
                               const std::atomic<bool>* cancel) = nullptr;

  [[nodiscard]] bool can_learn_primitives() const { return learn != nullptr; }
  [[nodiscard]] bool can_replay() const { return bend != nullptr; }
};

/// All kinds; the first one is the paper's.
[[nodiscard]] std::span<const MemoryKind* const> memory_kinds();
/// Error: an unknown name; the message lists the known ones.
[[nodiscard]] Result<const MemoryKind*> find_memory_kind(std::string_view name);
/// The kind of rows of this version; null if there is none.
[[nodiscard]] const MemoryKind* memory_kind_of(std::string_view version);
/// The default kind for primitives of scenes: see MemoryKind::rank_for_scenes.
[[nodiscard]] const MemoryKind& default_memory_kind(const Robot& robot);
/// The default kind for solved problems: see MemoryKind::rank_for_paths.
[[nodiscard]] const MemoryKind& default_kind_of_paths(const Robot& robot);

/// A setting whose default depends on the kind of memory, and its default for each kind, as text.
struct KindDefault {
  std::string_view setting;
  std::vector<std::string> values;  ///< in the order of the kinds
};
/// All such settings, for help and documents: "0.8 (0.5 with walks)" where escape walks matter.
[[nodiscard]] std::vector<KindDefault> kind_defaults(
    std::span<const MemoryKind* const> kinds = memory_kinds());

/// The kind of memory, and how a scene is cut into its primitives.
struct MemorySettings {
  std::optional<std::string> kind;  ///< one of memory_kinds(); the default depends on the function
  std::optional<double> max_gap;
};

template <class Settings, class Visitor>
requires std::same_as<std::remove_const_t<Settings>, MemorySettings>
void visit_settings(Settings& s, Visitor&& visit) {
  visit("max-gap", s.max_gap, 0.0, 1e6,
        "Largest distance between two obstacles that form a primitive, metres between surfaces. "
        "Default: by kind (see table).");
}

/// The kind that the settings name, or default_memory_kind().
[[nodiscard]] Result<const MemoryKind*> choose_kind(const Robot& robot,
                                                    const MemorySettings& settings);
/// Cuts a query into primitives of the kind that choose_kind() returns.
[[nodiscard]] Result<std::vector<LocalPrimitive>> decompose(const MemoryQuery& query,
                                                            const MemorySettings& settings = {});
/// Turns solved paths into rows of the kind that choose_kind() returns. For pairs of obstacles: one
/// row per primitive, whose components are the waypoints that belong to it, moved to the canonical
/// frame. A waypoint belongs to a primitive if one shape of the robot that the symmetric joints
/// move is closer than `reach` (metres) to all its obstacles. A primitive without a waypoint has no
/// row; rows have no provenance yet. O(waypoints * shapes * obstacles). Error: constraints, for a
/// kind that does not keep whole paths.
[[nodiscard]] Result<std::vector<Experience>> learn_from_paths(const MemoryQuery& query,
                                                               std::span<const Path> paths,
                                                               const MemorySettings& settings = {},
                                                               double reach = 0.12);

/// Stored experience of the kind whose similarity error to `primitive` is less than `threshold`,
/// nearest first, at most `max_matches` (0: all). Inspects at most `keys_left` keys and counts
/// these down. Errors: those of Database::find().
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

inline constexpr std::size_t kCirclePairKeySize = 6;
/// Brings a pair of circles to canonical form.
[[nodiscard]] LocalPrimitive make_primitive(const PrimitiveKey& circles);
/// The two circles of a key as a scene of their own.
[[nodiscard]] Scene make_scene(const PrimitiveKey& key);

/// Section IV-A of the paper: solves queries that start with the arm threaded through the gap,
/// stratified by the first link that crosses it, and end with the arm wholly out; shortcuts the
/// paths and places one component at each waypoint. No mean is in contact. Depends on the arguments
/// alone if `deadline_s` is 0; otherwise it stops after that many seconds with what it has, and in
/// any case within a few milliseconds once `cancel` is set. Errors: a robot that is no planar arm;
/// a key of another kind than "pairs".
[[nodiscard]] Result<LearnResult> learn_local_sampler(const Robot& robot, const PrimitiveKey& key,
                                                      const LearnSettings& settings,
                                                      std::uint64_t seed, double deadline_s = 0,
                                                      const std::atomic<bool>* cancel = nullptr);

/// Section V-A: greedily groups means that see each other along straight free motions, and replaces
/// each group by one component with the group's mean, and its covariance if it has more than
/// joint_count members. Components that have a factor already stay as they are, and groups whose
/// mean is in contact stay apart; members of a group count for the same source.
/// Stops merging once `is_late` returns true.
[[nodiscard]] LocalSampler merge_cliques(const CollisionChecker& checker,
                                         const LocalSampler& sampler,
                                         const std::function<bool()>& is_late = {});

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

// The kind "paths": whole solved paths, found by their ends and bent to those of the query.

/// A whole query as a primitive of the kind "paths": its key holds both
/// configurations, a continuous joint as its cosine and sine, and before them the distance between
/// these two rows. Its hash of the constraints keeps queries under others apart. The two images are
/// the query and its reverse; no obstacles count.
[[nodiscard]] LocalPrimitive make_query_primitive(
    const Robot& robot, std::span<const double> start, std::span<const double> goal,
    std::span<const OrientationConstraint> constraints = {});
/// Numbers in such a key.
[[nodiscard]] int query_key_size(const Robot& robot);

}  // namespace mneme
