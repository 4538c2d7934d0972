// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Problems of the planar arm, and memories that were learned near them.
#pragma once

#include "support/support.h"

#include <cmath>
#include <numbers>

namespace mneme::test {

inline constexpr double kPi = std::numbers::pi;

/// A problem of scenes/planar, such as "threaded_b4".
inline Problem planar_problem(const std::string& name) {
  ProblemOptions options;
  options.robot_path = source_file("robots/planar8.urdf");
  auto problem = load_problem(source_file("scenes/planar/" + name + ".yaml"), options);
  REQUIRE_MESSAGE(problem.has_value(), (problem ? "" : problem.error().message));
  return std::move(*problem);
}

inline CollisionChecker make_checker(const Robot& robot, const Scene& scene, double margin = 0) {
  CheckerSettings settings;
  settings.margin = margin;
  auto checker = CollisionChecker::make(robot, scene, settings);
  REQUIRE_MESSAGE(checker.has_value(), (checker ? "" : checker.error().message));
  return *checker;
}

inline Database make_database(const std::string& path, const Robot& robot,
                              OpenMode mode = OpenMode::create) {
  const auto space = make_space(robot);
  REQUIRE(space.has_value());
  auto database = Database::open(path, *space, mode);
  REQUIRE_MESSAGE(database.has_value(), (database ? "" : database.error().message));
  return std::move(*database);
}

inline LearnSettings cheap_settings() {
  LearnSettings settings;
  settings.starts_per_link = 1;
  settings.paths_per_start = 1;
  settings.max_iterations = 3000;
  return settings;
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

inline void learn_into(Database& database, const Robot& robot,
                       const std::vector<PrimitiveKey>& keys,
                       const LearnSettings& settings = cheap_settings()) {
  LearnJob job;
  job.settings = settings;
  const auto summary = learn_primitives(robot, keys, database, job);
  REQUIRE_MESSAGE(summary.has_value(), (summary ? "" : summary.error().message));
}

inline Configuration mean_of(const GaussianMixture& mixture, int component) {
  const auto begin = mixture.means.begin() + component * mixture.joint_count;
  return {begin, begin + mixture.joint_count};
}

}  // namespace mneme::test
