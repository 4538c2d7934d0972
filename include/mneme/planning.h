// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Sampling-based planners.
#pragma once

#include "mneme/base.h"
#include "mneme/path.h"
#include "mneme/sampling.h"

#include <atomic>
#include <concepts>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mneme {

enum class PlanStatus {
  solved,
  timeout,          ///< the time limit was reached
  iteration_limit,  ///< the iteration limit was reached
  node_limit,       ///< the limit on nodes, and so on memory, was reached
  cancelled,
  invalid_start,  ///< outside the limits, not a number, wrong count, or in contact: see `message`
  invalid_goal,   ///< the same of a goal
};
[[nodiscard]] std::string_view to_string(PlanStatus status);

/// Watches one call of a planner, for pictures and statistics. Called by the planning thread; the
/// observer's time counts as planning time.
class PlanObserver {
 public:
  virtual ~PlanObserver() = default;
  /// Receives a sampled configuration and its source.
  virtual void on_sample(std::span<const float>, SampleSource) {}
  /// Receives a free motion that the planner adds to `graph`: 0 is the tree from the start or the
  /// roadmap, 1 the tree from the goals. The motion may be dropped later, if it fails verification.
  virtual void on_edge(std::span<const float> /*from*/, std::span<const float> /*to*/,
                       int /*graph*/) {}
};

struct PlanSettings {
  std::optional<double> range = {};
  double timeout_s = 10;
  std::optional<std::uint64_t> max_iterations = {};
  std::uint64_t max_nodes = 10000000;
  std::uint64_t seed = 1;
  bool simplify = true;
  int patience = 28;
  std::optional<bool> minimize_time = {};
  /// Limits of the trajectory that the path is for; null if none is wanted.
  std::shared_ptr<const RateLimits> limits = nullptr;
  double improve = 0;
  std::optional<std::uint64_t> improve_rounds = {};
  bool verify = true;
  bool continuous = true;
  int neighbours = 10;
  double goal_bias = 0.05;
  std::optional<double> anchor = {};
  std::optional<double> anchor_sigma = {};
  std::optional<double> walk = {};
  std::optional<std::uint64_t> walk_after = {};
  bool ompl_defaults = false;
  /// File written by PlannerEntry::train, for planners with their own experience. Empty: none.
  std::string experience_path = {};
  /// Flag that another thread sets to stop the planner within a few milliseconds; may be null.
  const std::atomic<bool>* cancel = nullptr;
  /// Receives samples and edges; may be null, which costs nothing.
  PlanObserver* observer = nullptr;

  [[nodiscard]] Verification verification() const {
    if (!verify) return Verification::none;
    return continuous ? Verification::motions : Verification::states;
  }
  [[nodiscard]] bool minimizes_time() const { return minimize_time.value_or(limits != nullptr); }
  [[nodiscard]] FinishSettings finish() const {
    return {simplify, verification(), seed, timeout_s, cancel, patience, minimizes_time(), limits};
  }
};

/// Declares each setting once, for command line, files, Python, documents and report:
/// calls `visit(name, value, least, most, sentence)` for each. The sentence of a std::optional
/// value states its default.
template <class Settings, class Visitor>
requires std::same_as<std::remove_const_t<Settings>, PlanSettings>
void visit_settings(Settings& s, Visitor&& visit) {
  visit("range", s.range, 1e-3, 1e3,
        "Longest single extension of a tree, radians of L2 joint distance. Longer ones are "
        "rejected more often, shorter ones explore slowly. Default: the robot's (0.64 for a planar "
        "arm, 0.5 otherwise). With up to 10 joints the first 100 iterations use 1 instead, checked "
        "at half the resolution.");
  visit("timeout", s.timeout_s, 0.0, 1e6, "Time limit, seconds, kept within 10 ms.");
  visit("max-iterations", s.max_iterations, std::uint64_t{1}, ~std::uint64_t{0},
        "Iteration limit. With this limit and a seed, a run is repeatable under any load of the "
        "machine. Default: none.");
  visit("max-nodes", s.max_nodes, std::uint64_t{1}, ~std::uint64_t{0},
        "Largest number of nodes of all trees or of the roadmap. Bounds memory: about 100 bytes "
        "per node for 7 joints, 300 with prm.");
  visit("seed", s.seed, std::uint64_t{0}, ~std::uint64_t{0},
        "Seed of all random numbers. Same seed, inputs and instruction set: same path.");
  visit("simplify", s.simplify, false, true,
        "Shorten the path: drop and relax waypoints, straighten random joints over random "
        "stretches.");
  visit("patience", s.patience, 0, 1000000,
        "Shortening ends after this many checks of 16 states without a gain, or fewer if the path "
        "is nearly straight. More takes longer for a shorter path; 0 only drops waypoints.");
  visit("minimize-time", s.minimize_time, false, true,
        "Shorten, and improve, the time of a path instead of its L2 joint distance, within the "
        "limits of the trajectory or else of the URDF. Default: on if a trajectory is wanted.");
  visit("improve", s.improve, 0.0, 1e6,
        "Time to improve the path, seconds: plans from other seeds, and shortens the best one. "
        "At 0 paths of trajectories still get up to three such rounds.");
  visit("improve-rounds", s.improve_rounds, std::uint64_t{1}, ~std::uint64_t{0},
        "Largest number of rounds of improving; each after the first makes three plans (of least "
        "time: two). With a seed the result is repeatable. Default: as many as the time allows.");
  visit("verify", s.verify, false, true,
        "Check the final path. A motion that fails is repaired by a waypoint nearby. Where that "
        "fails, too, planning goes on without this motion.");
  visit("continuous", s.continuous, false, true,
        "Verification also rules out contact between states, by bounds on how far each link moves. "
        "Off: verification checks states at ten times the resolution.");
  visit("neighbours", s.neighbours, 1, 1000,
        "prm: connections to try per new milestone. More cost more motion checks.");
  visit("goal-bias", s.goal_bias, 0.0, 1.0,
        "rrt: probability of extending towards a goal instead of a sample.");
  visit("anchor", s.anchor, 0.0, 1.0,
        "rrt_connect, prm: probability of replacing a uniform sample by one around the newest "
        "node. At 1 a planner may make no progress; 0 turns anchors off. Default: 0.8.");
  visit("anchor-sigma", s.anchor_sigma, 0.0, 100.0,
        "Standard deviation of samples around a node, radians (half as many metres for prismatic "
        "joints). Default: 4 over the square root of the number of joints.");
  visit("walk", s.walk, 0.0, 1.0,
        "rrt_connect: share of the work that escape walks may take: small steps from the newest "
        "node that pull a limb back along itself, off all obstacles. Work is counted by what is "
        "computed, not timed. At 1 a planner may make no progress; 0 turns walks off. "
        "Default: the robot's (0.7 for a planar arm, 0.2 otherwise).");
  visit("walk-after", s.walk_after, std::uint64_t{0}, ~std::uint64_t{0},
        "rrt_connect: iterations before the first escape walk, so that easy problems do not pay "
        "for walks. Default: the robot's (0 for a planar arm, 3000 otherwise).");
  visit("ompl-defaults", s.ompl_defaults, false, true,
        "Run OMPL's planners with OMPL's own settings: range of a fifth of the extent, motions "
        "checked at a hundredth of it. Paths are neither verified nor remembered, and may tunnel "
        "through obstacles. Off: range 0.4 rad, motions checked and paths verified as for mneme's "
        "planners.");
}

/// The motion planning question: reach any of `goals` from `start`.
struct PlanQuery {
  Configuration start;
  std::vector<Configuration> goals;
};

struct PlanResult {
  PlanStatus status = PlanStatus::timeout;
  std::string message = {};      ///< why there is no path, in words; empty if solved
  Path path = {};                ///< from the start to the goal reached; empty unless solved
  std::uint64_t iterations = 0;  ///< samples, escape walks, and goals that rrt sampled instead
  std::uint64_t states_checked = 0;
  std::uint64_t motions_checked = 0;
  std::uint64_t nodes = 0;     ///< of all trees, or of the roadmap
  double planning_time_s = 0;  ///< without simplification and verification
  double simplification_time_s = 0;
  double verification_time_s = 0;

  [[nodiscard]] bool is_solved() const { return status == PlanStatus::solved; }
};

/// Returns status and message if the query cannot be planned, otherwise nothing. Reasons: the start
/// or a goal is outside the limits, breaks a constraint or is in contact, or there is no goal.
/// `are_ends_clear` skips the check for contact.
[[nodiscard]] std::optional<PlanResult> refuse_query(const CollisionChecker& checker,
                                                     const PlanQuery& query,
                                                     bool are_ends_clear = false);
/// Removes the goals from `goals` that refuse_query() refuses, unless it refuses all. Returns a
/// sentence for each removed goal.
[[nodiscard]] std::vector<std::string> drop_invalid_goals(const CollisionChecker& checker,
                                                          std::vector<Configuration>& goals,
                                                          bool are_ends_clear = false);

/// A pair whose spheres touch at the start or a goal is checked by exact geometry if that is at
/// least this far apart there, beyond the margin, metres.
inline constexpr double kSolidClearance = 1e-3;

/// The checker of a query.
struct QueryChecker {
  CollisionChecker checker;
  /// A sentence for each pair that is checked by exact geometry.
  std::vector<std::string> notes = {};
  bool are_ends_clear = false;  ///< True if start and goals are valid and free of contact.
};
/// Makes the checker of a query. Pairs whose spheres touch at the start or a goal, but whose exact
/// geometry is at least kSolidClearance apart there, are checked by exact geometry in the whole
/// query. The checker's scene lists them in Obstacle::exact_links and Scene::exact_pairs. Errors:
/// those of CollisionChecker::make.
[[nodiscard]] Result<QueryChecker> make_query_checker(const Robot& robot, const Scene& scene,
                                                      const CheckerSettings& settings,
                                                      const PlanQuery& ends);
/// The same, with a checker that CollisionChecker::make() returned for these settings.
[[nodiscard]] Result<QueryChecker> make_query_checker(const CollisionChecker& plain,
                                                      const CheckerSettings& settings,
                                                      const PlanQuery& ends);

/// Ends a search once another search has won. Called by the planning thread.
class SearchLimit {
 public:
  virtual ~SearchLimit() = default;
  /// Returns false if the search must end after this number of iterations.
  [[nodiscard]] virtual bool may_go_on(std::uint64_t iterations) = 0;
};

/// A remembered motion at a place.
struct PlacedMotion {
  std::vector<float> rows;  ///< configurations, row by row; they may be in contact
  int row = 0;              ///< number of the motion in its source
};

/// Remembered motions at the places where they fit into the scene. Belongs to one search.
class MotionSource {
 public:
  virtual ~MotionSource() = default;
  /// Looks for the places of one more remembered motion and appends the motion at each of them.
  /// Adds the checked states to `counters`. Returns false once no motion is left.
  [[nodiscard]] virtual bool find_more(std::vector<PlacedMotion>& placed,
                                       CheckCounters& counters) = 0;
  /// True if some places are known before find_more() checks anything.
  [[nodiscard]] virtual bool knows_places() const { return false; }
  /// Returns the share of the usual effort to take: 1, less if motions have hardly paid so far.
  [[nodiscard]] virtual double trust() const { return 1; }
  /// Receives the outcome of the search: the states that find_more() checked, and PlacedMotion::row
  /// of the motions that the path follows.
  virtual void report(std::uint64_t states, std::span<const int> followed) {
    static_cast<void>(states), static_cast<void>(followed);
  }
};

/// One call of a planner. All that it refers to must outlive the task.
struct PlanTask {
  const CollisionChecker& checker;
  const PlanQuery& query;  ///< precondition: refuse_query() does not refuse the query
  const Sampler& sampler;
  const PlanSettings& settings;
  PathFinisher& shorten_and_verify;
  /// Name of a sampler of valid states, for planners with `samples_valid_states`; empty: none.
  std::string_view valid_states = {};
  GoalSource* further_goals = nullptr;  ///< more goals for a long search; null: none
  SearchLimit* limit = nullptr;         ///< in addition to the limits of `settings`; null: none
  MotionSource* motions = nullptr;      ///< remembered motions for rrt_connect; null: none
};

/// Plans one query. Must not throw. Error: a file that the planner needs cannot be read.
using Planner = std::function<Result<PlanResult>(const PlanTask& task)>;

/// Grows a single tree from the start. LaValle and Kuffner, DOI 10.1177/02783640122067453.
[[nodiscard]] PlanResult rrt(const PlanTask& task);
/// Grows trees from the start and from all goals. Kuffner and LaValle, DOI
/// 10.1109/ROBOT.2000.844730.
[[nodiscard]] PlanResult rrt_connect(const PlanTask& task);
/// Grows a roadmap. Kavraki, Svestka, Latombe and Overmars, DOI 10.1109/70.508439.
[[nodiscard]] PlanResult prm(const PlanTask& task);

struct PlannerEntry {
  std::string name;
  std::string summary;
  Planner plan;
  bool samples_valid_states = false;  ///< Uses PlanTask::valid_states.
  bool is_exclusive = false;          ///< At most one run at a time in a process.
  /// Trains the planner's own experience from solved paths, of any scenes, and saves it for
  /// PlanSettings::experience_path. Empty: not trainable.
  std::function<Result<void>(const Robot& robot, std::span<const Path> paths,
                             const std::string& file)>
      train = {};
  bool walks = false;     ///< Makes escape walks unless PlanSettings::walk is 0.
  bool projects = false;  ///< Keeps constraints by projection.
};
/// Returns all planners: mneme's own, and those of add_planners().
[[nodiscard]] std::span<const PlannerEntry> planners();
[[nodiscard]] std::vector<std::string> planner_names();
/// Appends the planners whose names are new. Call this function before any other use of the table.
void add_planners(std::vector<PlannerEntry> entries);
/// Errors: invalid for an unknown name; unsupported for a planner of OMPL without OMPL's library.
[[nodiscard]] Result<const PlannerEntry*> find_planner(std::string_view name);

/// Checks start and goals, plans, shortens and verifies with one of mneme's own planners.
[[nodiscard]] PlanResult plan_with(PlanResult (*planner)(const PlanTask&),
                                   const CollisionChecker& checker, const PlanQuery& query,
                                   const Sampler& sampler, const PlanSettings& settings = {});

/// Returns the robot's default of PlanSettings::range, radians.
[[nodiscard]] double default_range(const Robot& robot);

}  // namespace mneme
