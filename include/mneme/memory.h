// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Kinds of memory: each cuts a query into local primitives, stores configurations per primitive,
/// and turns stored ones into samples for another query.
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
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace mneme {

// Primitives: parts of a workspace that experience is stored for.

/// The numbers that describe a primitive, in the robot's base frame; their meaning depends on the
/// kind of memory.
using PrimitiveKey = std::vector<double>;

/// A motion of the workspace that the leading joints can follow. In this order: the mirror image
/// y -> -y, which negates all joints of a planar arm; a rotation about the axis of the turning
/// joint; a shift along that axis.
struct Symmetry {
  double rotation = 0;  ///< radians
  bool is_mirrored = false;
  double lift = 0;  ///< metres along z
};
/// The inverse motion.
[[nodiscard]] Symmetry inverse(const Symmetry& motion);
/// The motion `first` followed by `second`.
[[nodiscard]] Symmetry compose(const Symmetry& second, const Symmetry& first);

/// The leading joints that move the rest of the robot rigidly. Symmetries do not apply to links
/// before them, such as a base or a head.
struct SymmetricJoints {
  int turn = -1;                  ///< index of the joint about z in a configuration, or -1
  int lift = -1;                  ///< index of the prismatic joint along z, or -1
  double axis_x = 0, axis_y = 0;  ///< intersection of the axis of `turn` with the plane z = 0,
                                  ///< metres
};
/// Finds the symmetric joints of the chain from the root: a prismatic joint along the root's z and
/// a revolute or continuous one about it, in either order. All further joints of the group must
/// follow them. Examples: joint 1 of a planar arm; torso lift and shoulder pan of Fetch. Cost:
/// O(links).
[[nodiscard]] SymmetricJoints find_symmetric_joints(const Robot& robot);

/// Returns the configuration that moves the links of `q` by `motion`. The turning joint is wrapped
/// to [-pi, pi); limits are not checked.
[[nodiscard]] Configuration moved_configuration(const SymmetricJoints& joints,
                                                const Symmetry& motion, std::span<const double> q);
/// Returns the pair of circles `key`, moved by `motion`.
[[nodiscard]] PrimitiveKey moved_key(const Symmetry& motion, const PrimitiveKey& key);

/// A local primitive lw_i of a query: a small group of obstacles, mostly a pair, that experience is
/// stored for.
struct LocalPrimitive {
  /// Indices of the primitive's obstacles in the query's scene. A primitive of make_primitive() has
  /// no query: its indices are into make_scene(key).
  std::vector<int> obstacles;
  std::string kind;  ///< MemoryKind::version of the kind that made the key.
  /// Canonical: the midpoint of the two obstacles' centres is on the positive x axis, seen from the
  /// axis of the turning joint. If the robot has a lift joint, the midpoint is also at z = 0.
  PrimitiveKey key;
  Symmetry to_scene = {};         ///< Motion from the canonical primitive to the scene.
  double gap = 0;                 ///< Distance between the two obstacles' surfaces, metres.
  bool is_whole_query = false;    ///< A start and a goal without obstacles (kind "paths").
  std::uint64_t constraints = 0;  ///< Hash of the constraints on a whole path. 0: none.
};

/// One of several equivalent keys of a canonical primitive, such as the other order of a pair. A
/// lookup queries all images, because a unique choice would be discontinuous.
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
  std::optional<double> resolution = {};
  std::optional<bool> walks = {};
  bool merge_cliques = false;
};

template <class Settings, class Visitor>
requires std::same_as<std::remove_const_t<Settings>, LearnSettings>
void visit_settings(Settings& s, Visitor&& visit) {
  visit("starts-per-link", s.starts_per_link, 1, 1000,
        "Number of local queries per link that can be in the gap. A local query plans among the "
        "primitive's obstacles alone. More make the sampler richer and slower to learn.");
  visit("paths-per-start", s.paths_per_start, 1, 1000,
        "Paths per local query. More make the sampler robust to obstacles outside the primitive.");
  visit("learn-iterations", s.max_iterations, 1, 100000000,
        "Iteration limit of one local query. A query that reaches the limit teaches nothing.");
  visit("learn-range", s.range, 1e-3, 1e3, "Extension range of local queries, radians.");
  visit("learn-resolution", s.resolution, 1e-4, 1.0,
        "Resolution of local queries, radians. Default: the robot's.");
  visit("learn-walks", s.walks, false, true,
        "Local queries use anchors and escape walks. Off: learning takes longer. Default: on. The "
        "paper: off.");
  visit("merge-cliques", s.merge_cliques, false, true,
        "Merge components whose means are all connected by free straight motions into one "
        "component with their covariance (section V-A of the paper). Makes a smaller database.");
}
/// The settings as one line of text, equal for equal settings; part of a row's provenance.
[[nodiscard]] std::string describe(const LearnSettings& settings);

struct LearnResult {
  LocalSampler sampler;          ///< in the canonical frame; no components if no query was solved
  int queries = 0;               ///< local queries planned
  int solved = 0;                ///< local queries solved
  std::uint64_t iterations = 0;  ///< sum over all local queries
  double time_s = 0;
};

// Kinds of memory.

/// A query to memory. Scene, start, goals and constraints must outlive the query.
struct MemoryQuery {
  Robot robot;  ///< without attached objects, which experience does not depend on
  const Scene& scene;
  const Configuration* start = nullptr;  ///< null if only the scene is known
  std::span<const Configuration> goals = {};
  std::span<const OrientationConstraint> constraints = {};
};

/// A stored experience that is similar to a primitive.
struct Match {
  std::shared_ptr<const Experience> experience;  ///< never null
  double similarity_error = 0;  ///< squared distance of the keys: m^2; rad^2 for whole paths
  Symmetry to_scene = {};       ///< motion from the stored means to the query's scene
};

/// A primitive of the query with its matches in memory.
struct PrimitiveRetrieval {
  LocalPrimitive primitive;
  std::vector<Match> matches = {};  ///< nearest first
  bool is_learned = false;          ///< learned during this query, because nothing matched
};

/// When memory is queried and how often it is sampled.
struct MemoryShare {
  double lambda = 0.5;
  std::optional<double> least_lambda = std::nullopt;  ///< none: lambda is constant
  int retrieve_after = 0;
};

/// Best measured settings of one kind. SolveSettings and MemorySettings explain each.
struct MemoryDefaults {
  MemoryShare share = {};
  /// Replaces `share` for planners with escape walks (PlanSettings::walk), which solve easy
  /// problems without memory. Default: `share`.
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

/// One kind of memory. To add one, write src/memory/NAME.cpp with a test and add its name to
/// src/memory/memory_kinds.cpp. Functions are parallel-safe.
struct MemoryKind {
  std::string_view name;
  /// Name and number, such as "pairs/1": the `kind` of stored rows. Raise the number when keys or
  /// means change their meaning; rows of other versions are ignored.
  std::string_view version;
  std::string_view summary;
  MemoryDefaults defaults;
  /// True if the kind supports the robot.
  bool (*handles)(const Robot& robot) = nullptr;
  /// Among kinds that support a robot, the one of highest rank is the default for primitives of
  /// scenes and for solved problems.
  int rank_for_scenes = 0, rank_for_paths = 0;
  /// Length of a key.
  int (*key_size)(const Robot& robot) = nullptr;
  /// Algorithm 2, line 1: cuts a query into primitives. `max_gap`: largest distance between two
  /// obstacles of a primitive, metres between surfaces. Errors: a robot or obstacles that the kind
  /// does not support; a missing start or goal.
  Result<std::vector<LocalPrimitive>> (*decompose)(const MemoryQuery& query,
                                                   double max_gap) = nullptr;
  /// All equivalent keys of a canonical key, itself first.
  std::vector<KeyImage> (*images)(const PrimitiveKey& canonical) = nullptr;
  /// Algorithm 2, line 10: turns matches into components for this query, in order of relevance. A
  /// component's source is the index of its retrieval.
  GaussianMixture (*synthesize)(const MemoryQuery& query,
                                std::span<const PrimitiveRetrieval> retrievals) = nullptr;
  /// Like synthesize(), but fits each mean to the query's primitives when it is first sampled. Each
  /// match is a group of components; the most relevant group is first. Sample sources are numbered
  /// from `first_source`. Null, or returns null, where only synthesize() is available.
  std::shared_ptr<const ComponentSource> (*retarget)(const MemoryQuery& query,
                                                     std::span<const PrimitiveRetrieval> retrievals,
                                                     SampleSource first_source) = nullptr;
  /// Returns a row's path, deformed to lead from the query's start to `goal`; empty if the row has
  /// no path. Null for a kind that does not store whole paths.
  Path (*bend)(const MemoryQuery& query, const Configuration& goal,
               const Experience& row) = nullptr;
  /// Turns solved paths of the query into rows with kind, key and content. Errors: those of
  /// `decompose`.
  Result<std::vector<Experience>> (*learn_from_paths)(const MemoryQuery& query,
                                                      std::span<const Path> paths, double max_gap,
                                                      double reach) = nullptr;
  /// Learns a primitive from its key by solving local queries; see learn_local_sampler(). Null for
  /// a kind that learns only from solved paths.
  Result<LearnResult> (*learn)(const Robot& robot, const PrimitiveKey& key,
                               const LearnSettings& settings, std::uint64_t seed, double deadline_s,
                               const std::atomic<bool>* cancel) = nullptr;

  /// Searches of less work, in iterations and checked states, teach nothing: 200,000 of them take
  /// about 0.1 s.
  std::uint64_t least_work = 0;
  /// True if rows are motions that belong to no primitive. Planners append such a motion to their
  /// trees where checks find that it fits.
  bool is_placed_by_checking = false;

  [[nodiscard]] bool can_learn_primitives() const { return learn != nullptr; }
  [[nodiscard]] bool can_replay() const { return bend != nullptr; }
};

/// All kinds; the paper's first.
[[nodiscard]] std::span<const MemoryKind* const> memory_kinds();
/// Finds a kind by name. Error: an unknown name; the message lists the known ones.
[[nodiscard]] Result<const MemoryKind*> find_memory_kind(std::string_view name);
/// Returns the kind of stored rows: its MemoryKind::version is `version`. Null if unknown.
[[nodiscard]] const MemoryKind* memory_kind_of(std::string_view version);
/// Default kind for primitives of scenes; see MemoryKind::rank_for_scenes.
[[nodiscard]] const MemoryKind& default_memory_kind(const Robot& robot);
/// Default kind for solved problems; see MemoryKind::rank_for_paths.
[[nodiscard]] const MemoryKind& default_kind_of_paths(const Robot& robot);

/// A setting whose default depends on the kind of memory, with these defaults as text.
struct KindDefault {
  std::string_view setting;
  std::vector<std::string> values;  ///< one per kind, in their order
};
/// Returns all settings whose default depends on the kind, for help and documents. A default that
/// also depends on escape walks reads "0.8 (0.5 with walks)".
[[nodiscard]] std::vector<KindDefault> kind_defaults();

/// Kind of memory and decomposition of scenes.
struct MemorySettings {
  std::optional<std::string> kind = {};  ///< name of one of memory_kinds(); each function states
                                         ///< its default
  std::optional<double> max_gap = {};
};

template <class Settings, class Visitor>
requires std::same_as<std::remove_const_t<Settings>, MemorySettings>
void visit_settings(Settings& s, Visitor&& visit) {
  visit("max-gap", s.max_gap, 0.0, 1e6,
        "Largest distance between two obstacles that form a primitive, metres between surfaces. "
        "Default: by kind (see table).");
}

/// Kind named by the settings, or default_memory_kind().
[[nodiscard]] Result<const MemoryKind*> choose_kind(const Robot& robot,
                                                    const MemorySettings& settings);
/// Cuts a query into primitives of the kind of choose_kind().
[[nodiscard]] Result<std::vector<LocalPrimitive>> decompose(const MemoryQuery& query,
                                                            const MemorySettings& settings = {});
/// Turns solved paths into rows of the kind of choose_kind(), without provenance. Kinds for pairs
/// of obstacles return one row per primitive that has waypoints: the waypoints, moved to the
/// canonical frame, are the row's components. A waypoint belongs to a primitive if a shape that the
/// symmetric joints move is closer than `reach` metres to all obstacles of the primitive. Cost:
/// O(waypoints * shapes * obstacles). Error: unsupported, for constraints with a kind that does not
/// store whole paths.
[[nodiscard]] Result<std::vector<Experience>> learn_from_paths(const MemoryQuery& query,
                                                               std::span<const Path> paths,
                                                               const MemorySettings& settings = {},
                                                               double reach = 0.12);

/// Limits of a lookup. Default: none.
struct MatchLimits {
  double similarity = std::numeric_limits<double>::infinity();  ///< errors are below: m^2; rad^2
                                                                ///< for whole paths
  int max_matches = 0;                                          ///< 0: all
  bool mirror = true;                                           ///< also match mirror images
};

/// Returns the stored experience of the kind that is like the primitive within the limits, nearest
/// first. `keys_left` and errors: see Database::find().
[[nodiscard]] Result<std::vector<Match>> find_matches(const Database& database,
                                                      const MemoryKind& kind,
                                                      const LocalPrimitive& primitive,
                                                      const MatchLimits& limits,
                                                      std::int64_t* keys_left = nullptr);

/// The paper's similarity error: least squared Euclidean distance between canonical key `a` and the
/// images of `b`. m^2; rad^2 for whole paths.
[[nodiscard]] double similarity_error(const MemoryKind& kind, const PrimitiveKey& a,
                                      const PrimitiveKey& b);

// The kind "pairs": two circles (x_a, y_a, r_a, x_b, y_b, r_b), metres, as in the paper. For planar
// arms. Pairs that overlap or that the arm cannot reach are skipped.

inline constexpr std::size_t kCirclePairKeySize = 6;
/// Brings a pair of circles to canonical form.
[[nodiscard]] LocalPrimitive make_primitive(const PrimitiveKey& circles);
/// A scene of the two circles of a key.
[[nodiscard]] Scene make_scene(const PrimitiveKey& key);

/// Learns a local sampler (section IV-A of the paper). Queries start with the arm threaded through
/// the gap, stratified by the first link that crosses it, and end with the arm outside. Each
/// waypoint of the shortened paths becomes one component; no mean is in contact. Stops after
/// `deadline_s` seconds (0: no limit, deterministic) or within a few milliseconds after `cancel` is
/// set, with the result so far. Errors: a robot that is no planar arm; a key that is not of the
/// kind "pairs".
[[nodiscard]] Result<LearnResult> learn_local_sampler(const Robot& robot, const PrimitiveKey& key,
                                                      const LearnSettings& settings,
                                                      std::uint64_t seed, double deadline_s = 0,
                                                      const std::atomic<bool>* cancel = nullptr);

/// Merges components (section V-A): greedily groups means that are pairwise connected by free
/// straight motions and have one source. A group becomes one component with the group's mean, and
/// with its covariance if the group has more than joint_count members. Components with a factor and
/// groups whose mean is in contact are kept unmerged. Stops merging once `is_late` returns true.
[[nodiscard]] LocalSampler merge_cliques(const CollisionChecker& checker,
                                         const LocalSampler& sampler,
                                         const std::function<bool()>& is_late = {});

// The kind "body_pairs": two obstacles of any shapes, touching ones too.

/// Numbers per obstacle in a key of the kind "body_pairs", metres: its centroid (x, y, z), then six
/// entries of a matrix S (xx, yy, zz, and sqrt(2) times xy, xz, yz). S is the square root of three
/// times the covariance of the obstacle's volume. For a box with half extents h and rotation R, S
/// is R diag(h) R^T, independent of the order and sign of its axes. Eigenvalues of S for a
/// cylinder: sqrt(3)/2 of its radius and half its length; for a sphere: sqrt(3/5) of its radius.
/// Shapes of one obstacle are weighted by volume.
inline constexpr int kBodyKeySize = 9;
/// Brings a pair of bodies to canonical form.
[[nodiscard]] LocalPrimitive make_body_primitive(const SymmetricJoints& joints, const Obstacle& a,
                                                 const Obstacle& b);

// The kind "paths": whole solved paths, found by their ends and deformed to lead from the query's
// start to its goal.

/// A whole query as a primitive of the kind "paths". Its key holds the distance between start and
/// goal, then both configurations, with cosine and sine for continuous joints. The two images of
/// the key are the query and its reverse. Obstacles are not part of the key.
[[nodiscard]] LocalPrimitive make_query_primitive(
    const Robot& robot, std::span<const double> start, std::span<const double> goal,
    std::span<const OrientationConstraint> constraints = {});
/// Length of a key of the kind "paths".
[[nodiscard]] int query_key_size(const Robot& robot);

}  // namespace mneme
