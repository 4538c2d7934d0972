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

/// How memory is used.
enum class MemoryMode {
  automatic,  ///< with the values that measure best for each kind
  off,        ///< not at all, even with a database
  paper,      ///< by the paper's literal rules
};
/// "auto", "off" or "paper".
[[nodiscard]] std::string_view to_string(MemoryMode mode);
/// The inverse of to_string(). Error: an unknown name.
[[nodiscard]] Result<MemoryMode> parse_memory_mode(std::string_view name);

struct SolveSettings {
  std::string planner = "rrt_connect";  ///< one of planners()
  std::string sampler = "gl";           ///< one of samplers()
  /// Default of the kind: all kinds that the database holds, or the robot's own if it is empty.
  MemorySettings memory;
  MemoryMode memory_mode = MemoryMode::automatic;
  std::optional<double> lambda;
  std::optional<double> least_lambda;
  std::optional<double> sigma;
  std::optional<double> similarity;
  std::optional<int> max_matches;
  std::optional<bool> drop_invalid_means;
  std::optional<bool> retarget;
  std::optional<int> retrieve_after;
  std::optional<double> first_components;
  double component_growth = 0.5;
  double learn_budget_s = 0;
  std::optional<int> remember_after;
  double replay = 0;
  std::optional<double> resolution;
  double margin = 0;
  int threads = 1;
  Isa isa = Isa::automatic;  ///< instruction set of the kernels
  PlanSettings plan;
  LearnSettings learn;
  IkSettings ik;  ///< of goals that are poses; their seed is that of `plan`
};

/// Declares the settings of this struct alone; those of `plan`, `memory`, `learn` and `ik` have
/// their own. The kind of memory determines defaults that are not set: see kind_defaults().
template <class Settings, class Visitor>
requires std::same_as<std::remove_const_t<Settings>, SolveSettings>
void visit_settings(Settings& s, Visitor&& visit) {
  visit("lambda", s.lambda, 0.0, 1.0,
        "Probability of a sample from memory instead of a uniform one, at first; see least-lambda. "
        "At 1 a planner may make no progress. Default: by kind (see table). The paper: 0.5.");
  visit("least-lambda", s.least_lambda, 0.0, 1.0,
        "Lower bound of lambda. After n memory samples the probability is lambda*h/(h+n), "
        "h = max(500, 25000*least-lambda), so that memory that does not fit costs a limited share. "
        "Default: by kind (see table). The paper: equal to lambda, which makes it constant.");
  visit("sigma", s.sigma, 0.0, 10.0,
        "Standard deviation of a mixture component, radians (half as many metres for prismatic "
        "joints). Smaller repeats the past, larger explores around it. Default: by kind (see "
        "table). The paper: 0.1.");
  visit(
      "similarity", s.similarity, 0.0, 1e9,
      "Retrieve samplers whose squared key distance is below this, m^2 (rad^2 for whole paths). "
      "A sampler of the very same key always counts. Default: by kind (see table). The paper: 3.");
  visit("max-matches", s.max_matches, 1, 1000000,
        "Nearest samplers to retrieve per primitive. More take longer and are less similar. "
        "Default: by kind (see table). The paper: all, which is the largest value.");
  visit("drop-invalid-means", s.drop_invalid_means, false, true,
        "Drop retrieved means that are in contact in the whole scene, after one batch of state "
        "checks. Samples around a mean just inside an obstacle may help. Default: by kind (see "
        "table). The paper: off.");
  visit(
      "retarget", s.retarget, false, true,
      "Fit each remembered mean to the query's own gap when it is first sampled, the most similar "
      "match first and one more match every 1000 samples. Off, or for kinds that cannot be "
      "fitted: the robot's symmetry moves all means before planning. Default: by kind (see "
      "table). The paper: off.");
  visit("retrieve-after", s.retrieve_after, 0, 1000000000,
        "Iterations with uniform samples before memory is queried, so that easy problems do not "
        "pay for it. Default: by kind (see table). The paper: 0.");
  visit("first-components", s.first_components, 1.0, 1e9,
        "Progressive widening: the number of most similar components to sample at first. Default: "
        "by kind (see table). The paper: all, which is the largest value.");
  visit("component-growth", s.component_growth, 0.0, 1e9,
        "Progressive widening: components to add per iteration.");
  visit("learn-budget", s.learn_budget_s, 0.0, 1e6,
        "Time per query to learn primitives without a match, seconds. It is part of planning time "
        "and ends with the time limit. A primitive whose lesson was cut short is learned further. "
        "Needs a kind of memory that learns primitives.");
  visit("remember-after", s.remember_after, 0, 1000000000,
        "Insert what a solved problem teaches once this many iterations have accumulated since the "
        "last insertion; 0: after each solved problem. Default: never.");
  visit(
      "replay", s.replay, 0.0, 1e6,
      "Known tasks: before any search, remembered paths whose ends are closer than this to the "
      "query's (key distance, radians) are bent to them, checked and repaired; 0: none. 0.5 suits "
      "a cell that repeats its tasks.");
  visit("resolution", s.resolution, 1e-4, 10.0,
        "Largest L2 joint distance between checked states of a motion, radians. Default: the "
        "robot's (0.02 for a planar arm, 1/32 otherwise).");
  visit("margin", s.margin, 0.0, 10.0,
        "Distance that the robot keeps from obstacles, start and goal included, metres. Does not "
        "apply between its own links.");
  visit("threads", s.threads, 1, 64,
        "Number of simultaneous searches from different seeds; the one with the fewest iterations "
        "wins. The path depends on this number, but not on timing. OMPL's planners take 1.");
}

/// The settings with the values of their memory mode where the caller set none. The paper's mode:
/// constant lambda of 0.5, sigma 0.1, similarity 3, all matches, all components from the start,
/// means moved by symmetry alone and not checked, no escape walks and no anchored samples.
[[nodiscard]] SolveSettings with_memory_mode(SolveSettings settings);

/// What memory is queried for, with `goals` for the problem's: the robot without attached objects.
/// Refers to both arguments.
[[nodiscard]] inline MemoryQuery memory_query(const Problem& problem,
                                              std::span<const Configuration> goals) {
  const Configuration* start = problem.start.empty() ? nullptr : &problem.start;
  return {problem.robot.without_attached(), problem.scene, start, goals, problem.constraints};
}
[[nodiscard]] inline MemoryQuery memory_query(const Problem& problem) {
  return memory_query(problem, problem.goals);
}

/// The result of Algorithm 2.
struct GlSampler {
  std::shared_ptr<const GaussianMixture>
      mixture;  ///< all retrieved components, in the scene's frame; null if there are none
  std::vector<PrimitiveRetrieval> primitives;
  double retrieval_time_s = 0;  ///< decomposition, lookup and synthesis
  double learning_time_s = 0;

  /// Matches of all primitives.
  [[nodiscard]] std::size_t retrieved_count() const {
    std::size_t count = 0;
    for (const PrimitiveRetrieval& retrieval : primitives) count += retrieval.matches.size();
    return count;
  }
};

/// Algorithm 2, "Create GL-Sampler", for the kinds of memory that the settings or the database say;
/// components of several kinds stand one after the other. Means that a symmetry moves outside the
/// joint limits are dropped. The database is changed only if `learn_budget_s` > 0 and a primitive
/// has no match but what a budget cut short, and less of that than is drawn from. Learning ends
/// `plan.timeout_s` after the call, and soon once `plan.cancel` is set.
/// Errors: those of MemoryKind::decompose; wrong_robot if the database is of another robot; invalid
/// if a setting is out of range, or if no kind that is asked can learn within a budget.
[[nodiscard]] Result<GlSampler> create_gl_sampler(const Problem& problem, Database& database,
                                                  const SolveSettings& settings);

/// Algorithm 1 over Algorithm 2 for a problem, as solve() draws with the sampler that the settings
/// name. Memory is asked now; the first `retrieve_after` samples are uniform nevertheless.
[[nodiscard]] Result<std::shared_ptr<const Sampler>> make_sampler(const Problem& problem,
                                                                  Database* database,
                                                                  const SolveSettings& settings);

/// What solve() inserted of a solved problem.
struct Remembered {
  int rows = 0;
  double time_s = 0;
  std::string failure;  ///< why nothing could be inserted; the path is found all the same
};

/// A path to be improved, or a shorter one that improving found.
struct Improved {
  double time_s = 0;  ///< since improving began; 0 for the first path
  double path_length = 0;
};

struct SolveResult {
  PlanResult plan;  ///< its planning time holds retrieval and learning, but no tables of the scene
  GlSampler gl;     ///< empty unless the sampler is of memory and there is a database
  Replay replay;
  Remembered remembered;
  /// Of paths one after the other, from the one that improving began with to the plan's; empty if
  /// it did not begin.
  std::vector<Improved> improvements;
  /// The problem's but for those in contact, those that its poses were resolved to at first, and
  /// the one that was reached.
  std::vector<Configuration> goals;
  /// For people: goals that were left out, pairs that were checked by exact geometry, and why.
  std::vector<std::string> notes;
  /// The problem's with the pairs that were checked by exact geometry (make_query_checker), if
  /// there are any.
  std::optional<Scene> scene;
  double goal_time_s = 0;      ///< of planning: resolving poses
  double total_time_s = 0;     ///< solve() from call to return
  double planning_time_s = 0;  ///< without what follows planning
  double improvement_time_s = 0;
  std::string planner;
  std::string sampler;
  std::uint64_t seed = 0;
  Isa isa = Isa::scalar;
};

/// The problem's scene as solve() checked it.
[[nodiscard]] inline const Scene& checked_scene(const Problem& problem, const SolveResult& result) {
  return result.scene ? *result.scene : problem.scene;
}

/// Resolves goals that are poses, decomposes the scene, retrieves or learns local samplers,
/// synthesizes one sampler, plans, shortens and verifies. `database` may be null: then samplers
/// that draw from memory draw uniformly. Errors: an unknown planner or sampler, or two that do not
/// go together; a setting out of range; a scene that cannot be checked or decomposed; a database of
/// another robot.
[[nodiscard]] Result<SolveResult> solve(const Problem& problem, Database* database,
                                        const SolveSettings& settings);

/// Refuses what solve() would of a problem and settings with a memory that holds nothing yet, so
/// that none is made in vain. Errors: those of solve() that are known before the goals are
/// resolved. Costs a checker of the scene.
[[nodiscard]] Result<void> check_query(const Problem& problem, const SolveSettings& settings);

/// The time-optimal motion along a path that solve() found for that problem with those settings:
/// corners are rounded where that passes the verification of paths. Errors: those of
/// parameterize().
[[nodiscard]] Result<Trajectory> make_trajectory(const Problem& problem,
                                                 const SolveSettings& settings, const Path& path,
                                                 const RateLimits& limits,
                                                 const TrajectorySettings& timing = {});

/// A source of configurations by name. To add one: a row in src/pipeline/samplers.cpp.
struct SamplerEntry {
  std::string_view name;
  std::string_view summary;
  /// Null: uniform within the joint limits.
  std::shared_ptr<const Sampler> (*make)(internal::MemorySampler& memory) = nullptr;
  bool draws_from_memory = false;   ///< from a database; without one it is uniform
  bool draws_valid_states = false;  ///< for planners that do so: see PlannerEntry
};
/// "gl" (Algorithm 1), "uniform" and "halton", then those that were added.
[[nodiscard]] std::span<const SamplerEntry> samplers();
[[nodiscard]] std::vector<std::string> sampler_names();
/// Adds samplers of another library; names that are known are left alone. Call it before planning:
/// not thread-safe, and references to entries end.
void add_samplers(std::span<const SamplerEntry> entries);
/// Error: an unknown name; the message lists those there are.
[[nodiscard]] Result<const SamplerEntry*> find_sampler(std::string_view name);

}  // namespace mneme
