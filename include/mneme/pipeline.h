// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Algorithms 1 and 2 of the paper: from a scene to a global sampler, and from a problem to a path.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "mneme/base.h"
#include "mneme/experience.h"
#include "mneme/learning.h"
#include "mneme/planning.h"
#include "mneme/primitive.h"
#include "mneme/problem.h"

namespace mneme {

struct SolveSettings {
  std::string planner = "rrt_connect";
  std::string sampler = "gl";
  double lambda = -1;
  double sigma = 0;
  double similarity = 0;
  int max_matches = -1;
  bool drop_invalid_means = true;
  int retrieve_after = -1;
  double first_components = -1;
  double component_growth = 0.5;
  double learn_budget_s = 0;
  int remember_after = -1;
  double resolution = 0;
  double margin = 0;
  Isa isa = Isa::automatic;  ///< instruction set of the kernels
  PlanSettings plan;
  DecomposeSettings decompose;
  LearnSettings learn;
};

/// Declares the settings of this struct alone; those of `plan`, `decompose` and `learn` have their
/// own.
template <class Settings, class Visitor>
requires std::same_as<std::remove_const_t<Settings>, SolveSettings>
void visit_settings(Settings& s, Visitor&& visit) {
  visit("lambda", s.lambda, -1.0, 1.0,
        "probability of drawing from the retrieved samplers instead of uniformly; at 1 a planner "
        "may never get anywhere; negative picks the default of the memory (0.7 for whole paths, "
        "0.5 otherwise)");
  visit("sigma", s.sigma, 0.0, 10.0,
        "standard deviation of a mixture component, radians (half as many metres for prismatic "
        "joints); smaller repeats the past, larger explores around it; 0 picks the default of the "
        "memory (0.05 for pairs, 0.07 for gaps, 0.3 for body_pairs, 0.4 for paths)");
  visit("similarity", s.similarity, 0.0, 1e9,
        "retrieve samplers whose squared key distance is less than this (m^2, for whole paths "
        "rad^2), and those of the same key whatever it is; 0 picks the default of the memory (0.5 "
        "for pairs, 0.05 for body_pairs, 0.03 for gaps, any for paths); the paper used 3");
  visit("max-matches", s.max_matches, -1, 1000000,
        "nearest samplers retrieved per primitive, 0 for all under the threshold (the paper's "
        "rule), -1 for the default of the memory (50 for whole paths, 8 otherwise)");
  visit("drop-invalid-means", s.drop_invalid_means, false, true,
        "drop retrieved means that are in contact in the whole scene, all in one batch of state "
        "checks; never done for body_pairs and paths, where samples around them help");
  visit("retrieve-after", s.retrieve_after, -1, 1000000000,
        "iterations with uniform samples before memory is asked, so that easy problems do not pay "
        "for it; -1 picks the default of the memory (0 for pairs, 1500 for body_pairs and gaps, "
        "2500 for paths)");
  visit("first-components", s.first_components, -1.0, 1e9,
        "progressive widening: draws are from this many of the most similar components first; 0 "
        "for all from the start (the paper's rule), -1 picks the default of the memory (0 for "
        "pairs and gaps, 20 otherwise)");
  visit("component-growth", s.component_growth, 0.0, 1e9,
        "progressive widening: components that are added per iteration");
  visit("learn-budget", s.learn_budget_s, 0.0, 1e6,
        "seconds per query for learning primitives that have no match, 0 for none; counts as "
        "planning time and ends with the time limit");
  visit("remember-after", s.remember_after, -1, 1000000000,
        "insert what a solved problem teaches, as learning from problems does, if it took at least "
        "this many iterations, so that memory grows with use; -1 for never. Not planning time");
  visit("resolution", s.resolution, 0.0, 10.0,
        "largest L2 joint distance between checked states of a motion, radians, 1e-4 or more; 0 "
        "for the robot's default");
  visit(
      "margin", s.margin, 0.0, 10.0,
      "metres that the robot keeps away from obstacles, start and goal included; not from itself");
}

/// The default `similarity` for the keys of a decomposer, by its name or version.
[[nodiscard]] double default_similarity(std::string_view decomposer);
/// The same for `max_matches`.
[[nodiscard]] int default_max_matches(std::string_view decomposer);

/// A stored experience that is similar to a primitive.
struct Match {
  std::shared_ptr<const Experience> experience;  ///< never null
  double similarity_error = 0;                   ///< squared distance of the keys
  Symmetry to_scene;  ///< takes the stored means to the primitive's scene
};
/// The experiences of `kind` whose similarity error to `primitive` is less than `threshold`, as
/// Database::find() says; its errors.
[[nodiscard]] Result<std::vector<Match>> find_matches(const Database& database,
                                                      std::string_view kind,
                                                      const LocalPrimitive& primitive,
                                                      double threshold, int max_matches);

/// A primitive of the scene and what the memory knew of it.
struct PrimitiveRetrieval {
  LocalPrimitive primitive;
  std::vector<Match> matches;  ///< nearest first
  bool is_learned = false;     ///< there was no match, and it was learned just now
};

/// The result of Algorithm 2.
struct GlSampler {
  std::shared_ptr<const GaussianMixture>
      mixture;  ///< all retrieved components, in the scene's frame; may be empty
  std::vector<PrimitiveRetrieval> primitives;
  double retrieval_time_s = 0;  ///< decomposition, lookup and synthesis
  double learning_time_s = 0;
};

/// Algorithm 2, "Create GL-Sampler". Means that a symmetry moves outside the joint limits are
/// dropped. The database is changed only if `learn_budget_s` > 0 and a primitive has no match.
/// Only pairs of circles are learned on a miss, by planar arms.
/// Learning ends `plan.timeout_s` after the call, and soon once `plan.cancel` is set.
/// Errors: those of decompose(); wrong_robot if the database is of another robot or decomposer;
/// invalid if it remembers whole paths, which need a problem, or if a setting is out of range.
[[nodiscard]] Result<GlSampler> create_gl_sampler(const Robot& robot, const Scene& scene,
                                                  Database& database,
                                                  const SolveSettings& settings);

/// The same for a problem. A database of whole paths is asked for paths of similar starts and
/// goals, once per goal, and bends them to the problem's.
[[nodiscard]] Result<GlSampler> create_gl_sampler(const Problem& problem, Database& database,
                                                  const SolveSettings& settings);

/// What solve() inserted of a solved problem.
struct Remembered {
  int rows = 0;
  double time_s = 0;
  std::string failure;  ///< why nothing could be inserted; the path is found all the same
};

struct SolveResult {
  PlanResult plan;  ///< its planning time holds retrieval and learning, but no tables of the scene
  GlSampler gl;     ///< empty unless the sampler is of memory and there is a database
  Remembered remembered;
  double total_time_s = 0;     ///< solve() from call to return
  double planning_time_s = 0;  ///< without simplification, verification and remembering
  std::string planner;
  std::string sampler;
  std::uint64_t seed = 0;
  Isa isa = Isa::scalar;
};

/// Decomposes the scene, retrieves or learns a local sampler per primitive, synthesizes one
/// sampler, plans. `database` may be null: then the sampler "gl" draws uniformly. Errors: an
/// unknown planner or sampler, a setting out of range, a scene that cannot be checked or
/// decomposed, a database of another robot or decomposer.
[[nodiscard]] Result<SolveResult> solve(const Problem& problem, Database* database,
                                        const SolveSettings& settings);

/// "gl", "uniform", "halton"; baselines on the same memory: "pooled", "nearest_scenes", "cvae".
[[nodiscard]] std::span<const std::string_view> sampler_names();

}  // namespace mneme
