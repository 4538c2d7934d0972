// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Algorithms 1 and 2 of the paper: from a scene to a global sampler, and from a problem to a path.
#pragma once

#include "mneme/base.h"
#include "mneme/goal.h"
#include "mneme/memory.h"
#include "mneme/planning.h"
#include "mneme/problem.h"
#include "mneme/replay.h"
#include "mneme/trajectory.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mneme {
namespace internal {
class MemorySampler;
}

/// Use of memory.
enum class MemoryMode {
  automatic,  ///< The defaults of each kind.
  off,        ///< No use of memory, even with a database.
  paper,      ///< All settings as in the paper: see with_memory_mode().
};
/// Returns "auto", "off" or "paper".
[[nodiscard]] std::string_view to_string(MemoryMode mode);
/// Inverse of to_string(). Errors: an unknown name.
[[nodiscard]] Result<MemoryMode> parse_memory_mode(std::string_view name);

struct SolveSettings {
  std::string planner = "rrt_connect";  ///< one of planners()
  std::string sampler = "gl";           ///< one of samplers()
  /// Default kind: all kinds in the database, or the robot's default kind if the database is empty.
  MemorySettings memory = {};
  MemoryMode memory_mode = MemoryMode::automatic;
  std::optional<double> lambda = {};
  std::optional<double> least_lambda = {};
  std::optional<double> sigma = {};
  std::optional<double> similarity = {};
  std::optional<int> max_matches = {};
  std::optional<bool> mirror = {};
  std::optional<bool> drop_invalid_means = {};
  std::optional<bool> retarget = {};
  std::optional<int> retrieve_after = {};
  std::optional<double> first_components = {};
  double component_growth = 0.5;
  double learn_budget_s = 0;
  std::optional<int> remember_after = {};
  std::optional<double> replay = {};
  std::optional<double> resolution = {};
  double margin = 0;
  double start_tolerance = 0.05;
  double allow_at_ends = 0.005;
  int threads = 1;
  Isa isa = Isa::automatic;  ///< instruction set of the kernels
  PlanSettings plan = {};
  LearnSettings learn = {};
  IkSettings ik = {};  ///< for pose goals; the seed is plan.seed
};

/// Declares the settings of this struct; `plan`, `memory`, `learn` and `ik` declare their own. The
/// kind of memory determines defaults that are not set: see kind_defaults().
template <class Settings, class Visitor>
requires std::same_as<std::remove_const_t<Settings>, SolveSettings>
void visit_settings(Settings& s, Visitor&& visit) {
  visit("lambda", s.lambda, 0.0, 1.0,
        "Probability of a sample from memory instead of a uniform one, at first; see least-lambda. "
        "At 1 a planner may make no progress. Default: by kind (see table). The paper: 0.5.");
  visit("least-lambda", s.least_lambda, 0.0, 1.0,
        "Lower bound of lambda. After n memory samples the probability is lambda*h/(h+n), h = "
        "max(500, 25000*least-lambda), so that memory that does not fit costs a limited share. "
        "Default: by kind (see table). The paper: equal to lambda, which makes it constant.");
  visit("sigma", s.sigma, 0.0, 10.0,
        "Standard deviation of a mixture component, radians (half as many metres for prismatic "
        "joints). Smaller repeats the past, larger explores. Default: by kind (see table). The "
        "paper: 0.1.");
  visit("similarity", s.similarity, 0.0, 1e9,
        "Retrieve samplers whose key has a squared distance to a primitive's key below this, m^2 "
        "(rad^2 for whole paths), or 0. Default: by kind (see table). The paper: 3.");
  visit("max-matches", s.max_matches, 1, 1000000,
        "Nearest samplers to retrieve per primitive. More take longer and are less similar. "
        "Default: by kind (see table). The paper: all, which is the largest value.");
  visit("mirror", s.mirror, false, true,
        "Also match mirror images of pairs of circles. Default: on. The paper: off.");
  visit("drop-invalid-means", s.drop_invalid_means, false, true,
        "Drop retrieved components whose mean is in contact. Off may help: samples around a mean "
        "just inside an obstacle can be free. Default: by kind (see table). The paper: off.");
  visit("retarget", s.retarget, false, true,
        "Fit each remembered mean to the query's gap when it is first sampled, the most similar "
        "match first and one more match every 1000 samples. Off: the robot's symmetry moves all "
        "means before planning. Default: by kind (see table). The paper: off.");
  visit("retrieve-after", s.retrieve_after, 0, 1000000000,
        "Iterations with uniform samples before memory is queried, so that easy problems do not "
        "pay for the query. Default: by kind (see table). The paper: 0.");
  visit("first-components", s.first_components, 1.0, 1e9,
        "Progressive widening: the number of most similar components to sample at first. Default: "
        "by kind (see table). The paper: all, which is the largest value.");
  visit("component-growth", s.component_growth, 0.0, 1e9,
        "Progressive widening: components to add per iteration.");
  visit("learn-budget", s.learn_budget_s, 0.0, 1e6,
        "Time per query to learn primitives without a match, seconds; within the time limit. A "
        "later query continues what was cut short. Needs a kind that learns primitives.");
  visit("remember-after", s.remember_after, 0, 1000000000,
        "Insert what a solved problem teaches once this many iterations have accumulated since the "
        "last insertion; 0: always, unless replay would come too late for it. Default: never.");
  visit("replay", s.replay, 0.0, 1e6,
        "First try remembered paths with ends closer to the query's than this, radians. Default: "
        "0.5 unless a kind is chosen; rrt_connect then searches for 64 iterations before.");
  visit("resolution", s.resolution, 1e-4, 10.0,
        "Largest L2 joint distance between checked states of a motion, radians. Default: the "
        "robot's (0.02 for a planar arm, 1/32 otherwise).");
  visit("margin", s.margin, 0.0, 10.0,
        "Least distance to obstacles, at start and goals too, but not between links, metres.");
  visit("start-tolerance", s.start_tolerance, 0.0, 1.0,
        "How far a start may be beyond limits or cones, radians (a tenth as many metres for "
        "prismatic joints). A start may also overlap anything by 1 mm. The first motion leads the "
        "robot inside. 0: no exception.");
  visit("allow-at-ends", s.allow_at_ends, 0.0, 1.0,
        "How far an attached object may move while it leaves a contact that exists at the start, "
        "or enters one that exists at a goal, metres. 0: no contact.");
  visit("threads", s.threads, 1, 64,
        "Number of simultaneous searches from different seeds; the one with the fewest iterations "
        "wins. The path depends on this number, but not on timing. OMPL's planners take 1.");
}

/// Returns the settings; those that are not set get the values of `memory_mode`. MemoryMode::paper:
/// constant lambda of 0.5, sigma 0.1, similarity 3, all matches, all components from the start,
/// means moved by symmetry only and not checked, no escape walks, no anchored samples, no replay.
[[nodiscard]] SolveSettings with_memory_mode(SolveSettings settings);

/// Returns what the settings allow at the ends of a path, for is_path_free().
[[nodiscard]] inline EndTolerances end_tolerances(const SolveSettings& settings) {
  constexpr double kMetresPerRadian = 0.1;
  const double length = kMetresPerRadian * settings.start_tolerance;
  const double depth = settings.start_tolerance > 0 ? EndTolerances().depth : 0;
  return {settings.start_tolerance, length, depth, settings.allow_at_ends};
}

/// Checks settings without a problem. Errors: a setting out of range; an unknown planner, sampler
/// or kind of memory; a combination that cannot work.
[[nodiscard]] Result<void> check_settings(const SolveSettings& settings);

/// Returns the query to memory for a problem, with these ends and the robot without attached
/// objects. The arguments must outlive the query.
[[nodiscard]] inline MemoryQuery memory_query(const Problem& problem, const Configuration& start,
                                              std::span<const Configuration> goals) {
  return {problem.robot.without_attached(), problem.scene, start.empty() ? nullptr : &start, goals,
          problem.constraints};
}
[[nodiscard]] inline MemoryQuery memory_query(const Problem& problem) {
  return memory_query(problem, problem.start, problem.goals);
}

/// The result of Algorithm 2.
struct GlSampler {
  /// All retrieved components, in the scene's frame, of which there may be none. Null if memory was
  /// not queried.
  std::shared_ptr<const GaussianMixture> mixture = {};
  std::vector<PrimitiveRetrieval> primitives = {};
  double retrieval_time_s = 0;  ///< decomposition, lookup and synthesis
  double learning_time_s = 0;

  /// Returns the number of matches of all primitives.
  [[nodiscard]] std::size_t retrieved_count() const {
    std::size_t count = 0;
    for (const PrimitiveRetrieval& retrieval : primitives) count += retrieval.matches.size();
    return count;
  }
};

/// Returns the sampler of the settings for a problem, Algorithm 1 over Algorithm 2, as solve() uses
/// it. Queries memory at once, but the first `retrieve_after` samples are uniform.
[[nodiscard]] Result<std::shared_ptr<const Sampler>> make_sampler(const Problem& problem,
                                                                  Database* database,
                                                                  const SolveSettings& settings);

/// Tells how solve() remembered a solved problem.
struct Remembered {
  bool is_queued = false;  ///< rows are made and stored meanwhile: see Database::queued_rows()
  double time_s = 0;
  std::string failure = {};  ///< Why nothing could be queued; the path is valid nevertheless.
};

/// A better path found by improvement: a shorter one, or a faster one if
/// PlanSettings::minimizes_time().
struct Improved {
  double time_s = 0;  ///< since improvement began; 0 for the first path
  double path_length = 0;
};

struct SolveResult {
  PlanResult plan = {};  ///< PlanResult::planning_time_s includes retrieval and learning
  GlSampler gl = {};     ///< empty unless the sampler queried a database
  Replay replay = {};
  Remembered remembered = {};
  /// From the first path to the plan's path, each shorter than the one before, or faster if
  /// PlanSettings::minimizes_time(): such paths may be longer. Empty without improvement.
  std::vector<Improved> improvements = {};
  /// The problem's goals except those in contact, then configurations for `pose_goals`, then the
  /// goal reached.
  std::vector<Configuration> goals = {};
  /// For people: goals that were ignored, exceptions at the ends of the path, pairs that were
  /// checked by exact geometry, and why.
  std::vector<std::string> notes = {};
  /// The problem's scene with the pairs that were checked by exact geometry (make_query_checker);
  /// empty without such pairs.
  std::optional<Scene> scene = {};
  double preparation_time_s = 0;  ///< making the collision checker; not part of the time limit
  double goal_time_s = 0;         ///< part of planning: resolving pose goals
  double total_time_s = 0;        ///< solve() from call to return
  double planning_time_s = 0;     ///< total time without preparation, shortening, verification,
                                  ///< improvement and remembering
  double improvement_time_s = 0;
  std::string planner = {};
  std::string sampler = {};
  std::uint64_t seed = 0;
  Isa isa = Isa::scalar;
};

/// Returns the problem's scene as solve() checked it.
[[nodiscard]] inline const Scene& checked_scene(const Problem& problem, const SolveResult& result) {
  return result.scene ? *result.scene : problem.scene;
}

/// Resolves pose goals, decomposes the scene, retrieves or learns local samplers, synthesizes one
/// sampler, plans, shortens and verifies. With a null `database`, samplers of memory are uniform.
/// The path begins at the start as given and is unwrapped: see unwrapped(). end_tolerances() states
/// the exceptions for the path's first and last motion. Where attached objects may touch obstacles
/// (Obstacle::may_touch), half of the time is first spent on a path that touches them at its ends
/// only. Errors: those of check_settings(); a scene that cannot be checked or decomposed; a
/// database of another robot.
[[nodiscard]] Result<SolveResult> solve(const Problem& problem, Database* database,
                                        const SolveSettings& settings);

/// Learns more from a problem whose search was long, in time that nothing else needs. Plans it
/// twice more from other seeds and remembers the paths. Looks for the places of all motions of the
/// memory in its scene: later queries of this process know them. Ends some milliseconds after
/// `plan.cancel` is set. Errors: those of solve(); io if no row is stored for plan.timeout_s
/// seconds.
[[nodiscard]] Result<void> study(const Problem& problem, Database& database,
                                 const SolveSettings& settings);

/// Settings of plan_many().
struct ManySettings {
  SolveSettings solve = {};
  int jobs = 0;  ///< Threads; 0: one per hardware thread.
  /// Times each path and samples its trajectory every `timing->dt` seconds. Default: paths only.
  std::optional<TrajectorySettings> timing = {};
};
struct TimedSolution {
  SolveResult result;
  std::vector<Trajectory::Point> trajectory = {};  ///< Empty without `timing`, or without a path.
};

/// Solves independent problems on several threads: each as solve() and make_trajectory() would
/// alone, so that results do not depend on `jobs`. The error of a single problem is the result of
/// that problem. Error: settings that make a problem depend on others, which are learn_budget_s,
/// remember_after and an observer. Problems are cheap to copy: robots and meshes are shared.
[[nodiscard]] Result<std::vector<Result<TimedSolution>>> plan_many(
    std::span<const Problem> problems, Database* database, const ManySettings& settings);

/// Checks problem and settings as solve() with an empty database would, for callers that then
/// create the database. Errors: those of solve() that are known before goals are resolved. Cost: a
/// collision checker.
[[nodiscard]] Result<void> check_query(const Problem& problem, const SolveSettings& settings);

/// Returns the time-optimal motion along a path that solve() found for this problem and settings.
/// Rounds corners where the result passes verification. Errors: those of parameterize().
[[nodiscard]] Result<Trajectory> make_trajectory(const Problem& problem,
                                                 const SolveSettings& settings, const Path& path,
                                                 const RateLimits& limits,
                                                 const TrajectorySettings& timing = {});

/// A sampler by name. To add one: a row in src/pipeline/samplers.cpp.
struct SamplerEntry {
  std::string_view name;
  std::string_view summary;
  /// Null: uniform within the joint limits.
  std::shared_ptr<const Sampler> (*make)(internal::MemorySampler& memory) = nullptr;
  bool uses_memory = false;           ///< Queries a database; uniform without one.
  bool samples_valid_states = false;  ///< Samples valid states: see
                                      ///< PlannerEntry::samples_valid_states.
};
/// Returns "gl" (Algorithm 1), "uniform", "halton", and the samplers of add_samplers().
[[nodiscard]] std::span<const SamplerEntry> samplers();
[[nodiscard]] std::vector<std::string> sampler_names();
/// Adds samplers whose names are new. Call this function before planning: it is not thread-safe and
/// invalidates references to entries.
void add_samplers(std::span<const SamplerEntry> entries);
/// Errors: an unknown name; the message lists the known ones.
[[nodiscard]] Result<const SamplerEntry*> find_sampler(std::string_view name);

}  // namespace mneme
