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

/// Watches one call of a planner, for pictures and statistics. Called by the thread that plans,
/// whose time it takes.
class PlanObserver {
 public:
  virtual ~PlanObserver() = default;
  /// A configuration that the planner drew, and its source.
  virtual void on_sample(std::span<const float>, SampleSource) {}
  /// A free motion `from` -> `to` that the planner keeps in `graph`: 0 is the tree from the start
  /// or the roadmap, 1 the tree from the goals. It may be dropped later, if it fails verification.
  virtual void on_edge(std::span<const float> /*from*/, std::span<const float> /*to*/,
                       int /*graph*/) {}
};

struct PlanSettings {
  std::optional<double> range;
  double timeout_s = 10;
  std::optional<std::uint64_t> max_iterations;
  std::uint64_t max_nodes = 10000000;
  std::uint64_t seed = 1;
  bool simplify = true;
  int patience = 40;
  double improve = 0;
  std::optional<std::uint64_t> improve_rounds;
  bool verify = true;
  bool continuous = true;
  int neighbours = 10;
  double goal_bias = 0.05;
  double anchor = 0.8;
  std::optional<double> anchor_sigma;
  std::optional<double> walk;
  std::optional<std::uint64_t> walk_after;
  bool ompl_defaults = false;
  /// What PlannerEntry::train wrote, for planners that plan from experience of their own; without
  /// it they know nothing.
  std::string experience_path;
  /// Set by another thread to stop the planner within a few milliseconds; may be null.
  const std::atomic<bool>* cancel = nullptr;
  /// Sees what the planner draws and keeps; may be null, which costs nothing.
  PlanObserver* observer = nullptr;

  [[nodiscard]] Verification verification() const {
    if (!verify) return Verification::none;
    return continuous ? Verification::motions : Verification::states;
  }
  [[nodiscard]] FinishSettings finish() const {
    return {simplify, verification(), seed, timeout_s, cancel, patience};
  }
};

/// Declares each setting once, for command line, files, Python, documents and report:
/// `visit(name, value, least, most, sentence)` is called for each. A value that is std::optional
/// has no number of its own until one is given: the sentence says what happens then.
template <class Settings, class Visitor>
requires std::same_as<std::remove_const_t<Settings>, PlanSettings>
void visit_settings(Settings& s, Visitor&& visit) {
  visit("range", s.range, 1e-3, 1e3,
        "Longest single extension of a tree, radians of L2 joint distance. Longer ones are "
        "rejected more often, shorter ones explore slowly. Default: the robot's (0.64 for a planar "
        "arm, 0.5 otherwise).");
  visit("timeout", s.timeout_s, 0.0, 1e6, "Time limit, seconds, kept within 10 ms.");
  visit("max-iterations", s.max_iterations, std::uint64_t{1}, ~std::uint64_t{0},
        "Iteration limit. With a seed it makes a run repeatable under any load of the machine. "
        "Default: none.");
  visit("max-nodes", s.max_nodes, std::uint64_t{1}, ~std::uint64_t{0},
        "Largest number of nodes of all trees or of the roadmap. Bounds memory: about 100 bytes "
        "per node for 7 joints, 300 with prm.");
  visit("seed", s.seed, std::uint64_t{0}, ~std::uint64_t{0},
        "Seed of all random numbers. Same seed, inputs and instruction set: same path.");
  visit("simplify", s.simplify, false, true,
        "Shorten the path: drop and relax waypoints, straighten random joints over random "
        "stretches.");
  visit("patience", s.patience, 0, 1000000,
        "Shortening ends after this many checks of 16 states in vain. More takes longer for a "
        "shorter path; 0 only drops waypoints.");
  visit("improve", s.improve, 0.0, 1e6,
        "Time to look for shorter paths once there is one, seconds. Plans from other seeds, "
        "several at once, and shortens the best one further.");
  visit("improve-rounds", s.improve_rounds, std::uint64_t{1}, ~std::uint64_t{0},
        "Largest number of rounds of improving, of three plans each after the first. With a seed "
        "it makes them repeatable. Default: as many as the time allows.");
  visit("verify", s.verify, false, true,
        "Check the final path. Motions that fail are mended, or removed and planning goes on.");
  visit("continuous", s.continuous, false, true,
        "Verification also rules out contact between states, by bounds on how far each link moves. "
        "Off: it checks states at ten times the resolution.");
  visit("neighbours", s.neighbours, 1, 1000,
        "prm: connections to try per new milestone. More cost more motion checks.");
  visit("goal-bias", s.goal_bias, 0.0, 1.0,
        "rrt: probability of extending towards a goal instead of a sample.");
  visit("anchor", s.anchor, 0.0, 1.0,
        "rrt_connect, prm: probability of replacing a uniform sample by one around the newest "
        "node. At 1 a planner may make no progress; 0 is the textbook's planner.");
  visit("anchor-sigma", s.anchor_sigma, 0.0, 100.0,
        "Standard deviation of samples around a node, radians (half as many metres for prismatic "
        "joints). Default: 4 over the square root of the number of joints.");
  visit("walk", s.walk, 0.0, 1.0,
        "rrt_connect: probability of an escape walk from the newest node instead of growth towards "
        "a sample. At 1 a planner may make no progress; 0 is the textbook's planner. Default: the "
        "robot's (0.15 for a planar arm, 0.1 otherwise).");
  visit("walk-after", s.walk_after, std::uint64_t{0}, ~std::uint64_t{0},
        "rrt_connect: iterations before the first escape walk, so that easy problems do not pay "
        "for it. Default: the robot's (0 for a planar arm, 3000 otherwise).");
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
  std::string message;  ///< why there is no path, in words; empty if solved
  Path path;            ///< empty unless solved; starts at the start and ends at the goal reached
  std::uint64_t iterations = 0;  ///< samples drawn, escape walks, and goals that rrt drew instead
  std::uint64_t states_checked = 0;
  std::uint64_t motions_checked = 0;
  std::uint64_t nodes = 0;     ///< of all trees, or of the roadmap
  double planning_time_s = 0;  ///< without simplification and verification
  double simplification_time_s = 0;
  double verification_time_s = 0;

  [[nodiscard]] bool is_solved() const { return status == PlanStatus::solved; }
};

/// Status and message of a query that no planner takes: its start or a goal is no configuration of
/// the robot, or in contact, or there is no goal. Nothing if the query is sound. Contact is not
/// looked for where the ends are known to be clear of it.
[[nodiscard]] std::optional<PlanResult> refuse_query(const CollisionChecker& checker,
                                                     const PlanQuery& query,
                                                     bool are_ends_clear = false);
/// Takes the goals in contact out of `goals` unless all of them are. A sentence about each.
[[nodiscard]] std::vector<std::string> drop_goals_in_contact(const CollisionChecker& checker,
                                                             std::vector<Configuration>& goals);

/// Metres that exact geometry must be away, beyond the margin, where spheres touch.
inline constexpr double kSolidClearance = 1e-3;

/// A checker for the way between the ends of a query.
struct QueryChecker {
  CollisionChecker checker;
  std::vector<std::string>
      notes;  ///< pairs that are checked by exact geometry, and why: a sentence each
  bool are_ends_clear = false;  ///< start and goals are configurations that touch nothing
};
/// CollisionChecker::make. Where, at the start or at a goal, nothing but spheres of links touches,
/// and their exact geometry is kSolidClearance away, these links are checked against the obstacles
/// and links that they touch by exact geometry (Obstacle::exact_links and Scene::exact_pairs in the
/// checker's scene): everywhere, not only there.
[[nodiscard]] Result<QueryChecker> make_query_checker(const Robot& robot, const Scene& scene,
                                                      const CheckerSettings& settings,
                                                      const PlanQuery& ends);

/// Ends a search that another one has beaten. Asked by the thread that plans.
class SearchLimit {
 public:
  virtual ~SearchLimit() = default;
  /// False if a search that has begun so many iterations must end before the next one.
  [[nodiscard]] virtual bool may_go_on(std::uint64_t iterations) = 0;
};

/// One call of a planner. Refers to all of it.
struct PlanTask {
  const CollisionChecker& checker;
  const PlanQuery& query;  ///< sound: refuse_query() has nothing to say
  const Sampler& sampler;
  const PlanSettings& settings;
  PathFinisher& shorten_and_verify;  ///< what a path must become and pass before it is returned
  /// The sampler of valid states to draw through, of planners that can; empty for none.
  std::string_view valid_states = {};
  /// Goals besides those of the query, which a long search takes as they come; null: none.
  GoalSource* further_goals = nullptr;
  /// Null: none but those of the settings. Planners that do not ask go on to their own end.
  SearchLimit* limit = nullptr;
};

/// A planner never throws; allocation of memory counts in its times. Errors: what it needs besides
/// the task cannot be read.
using Planner = std::function<Result<PlanResult>(const PlanTask& task)>;

/// A single tree from the start. LaValle and Kuffner, DOI 10.1177/02783640122067453.
[[nodiscard]] PlanResult rrt(const PlanTask& task);
/// Trees from the start and from all goals. Kuffner and LaValle, DOI 10.1109/ROBOT.2000.844730.
[[nodiscard]] PlanResult rrt_connect(const PlanTask& task);
/// An incremental roadmap. Kavraki, Svestka, Latombe and Overmars, DOI 10.1109/70.508439.
[[nodiscard]] PlanResult prm(const PlanTask& task);

struct PlannerEntry {
  std::string name;
  std::string summary;
  Planner plan;
  bool draws_valid_states = false;  ///< through the sampler that PlanTask::valid_states names
  bool is_exclusive = false;        ///< one run at a time in a process: it shares random numbers
  /// Writes what a planner that learns by itself makes of solved paths, whatever scene each was
  /// solved in, to a file for PlanSettings::experience_path; empty if it does not learn.
  std::function<Result<void>(const Robot& robot, std::span<const Path> paths,
                             const std::string& file)>
      train = {};
  bool walks = false;     ///< goes on escape walks, unless PlanSettings::walk is 0
  bool projects = false;  ///< leads its steps back to where constraints are kept
};
/// All planners: mneme's own, and those of add_planners(). To add one of mneme's own:
/// src/planning/NAME.cpp, a declaration above, a row in src/planning/planners.cpp, a test; command
/// line, Python, benchmark and the tests that all planners share take it from there.
[[nodiscard]] std::span<const PlannerEntry> planners();
[[nodiscard]] std::vector<std::string> planner_names();
/// Appends to the table those whose names it does not have yet. Before any other use of the table.
void add_planners(std::vector<PlannerEntry> entries);
/// Errors: invalid, with the names there are; unsupported for one of OMPL's if they were not added.
[[nodiscard]] Result<const PlannerEntry*> find_planner(std::string_view name);

/// One of mneme's own planners by itself: checks start and goals, then plans, and finishes paths as
/// the settings say.
[[nodiscard]] PlanResult plan_with(PlanResult (*planner)(const PlanTask&),
                                   const CollisionChecker& checker, const PlanQuery& query,
                                   const Sampler& sampler, const PlanSettings& settings = {});

/// The robot's default extension range, radians.
[[nodiscard]] double default_range(const Robot& robot);

}  // namespace mneme
