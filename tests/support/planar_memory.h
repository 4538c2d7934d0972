// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Planar arms, pairs of circles that planar8 can thread itself through, and memories of them that
/// take milliseconds to learn.
#pragma once

#include "support/support.h"

#include <algorithm>
#include <cmath>

namespace mneme::test {

inline Robot require_arm(const std::string& urdf) { return require(parse_robot(urdf, "arm.urdf")); }

inline Robot planar_arm(const std::vector<double>& lengths, double thickness = 0.001) {
  return require_arm(require(planar_arm_urdf("arm", lengths, thickness)));
}

/// The same with other limits of all joints but the first, which turns all the way.
inline Robot limited_arm(const std::vector<double>& lengths, double lower, double upper) {
  std::string urdf = planar_arm_urdf("limited", lengths, 0.001).value();
  const std::string full = R"(lower="-3.141592653589793" upper="3.141592653589793")";
  const std::string limits =
      "lower=\"" + std::to_string(lower) + "\" upper=\"" + std::to_string(upper) + "\"";
  REQUIRE(contains(urdf, full));
  for (std::size_t at = 0; (at = urdf.find(full)) != std::string::npos;) {
    urdf.replace(at, full.size(), limits);
  }
  return require_arm(urdf);
}

/// Lengths of planar8's links.
inline std::vector<double> planar8_lengths() { return {1.6, 1.4, 1.8, 1.2, 1.5, 1.3, 1.1, 1.7}; }

/// An arm of one joint that turns about the y axis.
inline Robot upright_arm() {
  return require_arm(R"(<robot name="upright">
    <link name="base"/>
    <link name="arm"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
    <joint name="j" type="continuous">
      <parent link="base"/><child link="arm"/><axis xyz="0 1 0"/></joint>
    </robot>)");
}

/// A problem of scenes/planar, such as "threaded_b4".
inline Problem planar_problem(const std::string& name) {
  ProblemOptions options;
  options.robot_path = source_file("robots/planar8.urdf");
  return require(load_problem(source_file("scenes/planar/" + name + ".yaml"), options));
}

inline CollisionChecker make_checker(const Robot& robot, const Scene& scene, double margin = 0) {
  return require(CollisionChecker::make(robot, scene, {.margin = margin}));
}

/// A pair of circles well within the arm's reach, canonical.
inline PrimitiveKey near_pair() { return make_primitive({3, 1.4, 1.2, 3.4, -1.5, 1.3}).key; }

/// Keys whose numbers differ from those of `key` by at most `spread`; canonical, with a gap.
inline std::vector<PrimitiveKey> keys_near(const PrimitiveKey& key, int count, double spread,
                                           std::uint64_t seed) {
  Rng rng(seed);
  std::vector<PrimitiveKey> keys;
  while (static_cast<int>(keys.size()) < count) {
    PrimitiveKey moved = key;
    for (double& value : moved) value += rng.uniform(-spread, spread);
    const LocalPrimitive primitive = make_primitive(moved);
    if (primitive.gap > 0.15) keys.push_back(primitive.key);
  }
  return keys;
}

/// Pairs within the arm's reach.
inline PrimitiveGrid near_grid() {
  PrimitiveGrid grid;
  grid.gap = {0.2, 0.8};
  grid.distance = {1.5, 7};
  return grid;
}

inline std::vector<PrimitiveKey> random_keys(int count, std::uint64_t seed) {
  Rng rng(seed);
  std::vector<PrimitiveKey> keys;
  for (int i = 0; i < count; ++i) keys.push_back(sample_primitive(near_grid(), rng));
  return keys;
}

inline LearnSettings cheap_settings() {
  LearnSettings settings;
  settings.starts_per_link = 1;
  settings.paths_per_start = 1;
  settings.max_iterations = 3000;
  return settings;
}

inline LearnResult learn(const Robot& robot, const PrimitiveKey& key, const LearnSettings& settings,
                         std::uint64_t seed, double deadline_s = 0) {
  return require(learn_local_sampler(robot, key, settings, seed, deadline_s));
}

inline Configuration mean_of(const GaussianMixture& mixture, int component) {
  const auto begin = mixture.means.begin() + component * mixture.joint_count;
  return {begin, begin + mixture.joint_count};
}

inline bool is_same_mixture(const GaussianMixture& a, const GaussianMixture& b) {
  return a.joint_count == b.joint_count && a.means == b.means && a.factor_rows == b.factor_rows &&
         a.factors == b.factors;
}

inline Database make_database(const std::string& path, const Robot& robot,
                              OpenMode mode = OpenMode::create) {
  return require(Database::open(path, make_signature(robot), mode));
}

/// A problem of `scene` between two configurations that are free in it.
inline Problem problem_in(const Robot& robot, const Scene& scene) {
  const CollisionChecker checker = make_checker(robot, scene);
  Rng rng(1);
  const auto sample_free = [&] {
    for (;;) {
      Configuration q = random_configuration(robot, rng);
      if (checker.is_valid(std::span<const double>(q))) return q;
    }
  };
  return {.robot = robot, .scene = scene, .start = sample_free(), .goals = {sample_free()}};
}

/// Runs Algorithm 2 for a problem: returns all matches with their components as stored.
inline Result<GlSampler> recall(const Problem& problem, Database& database,
                                SolveSettings settings = {}) {
  settings.retarget = false;
  settings.drop_invalid_means = false;
  settings.retrieve_after = 0;
  settings.plan.max_iterations = 1;
  return solve(problem, &database, settings).map([](const SolveResult& result) {
    return result.gl;
  });
}

inline void learn_into(Database& database, const Robot& robot,
                       const std::vector<PrimitiveKey>& keys,
                       const LearnSettings& settings = cheap_settings()) {
  LearnJob job;
  job.settings = settings;
  require(learn_primitives(robot, keys, database, job));
}

}  // namespace mneme::test
