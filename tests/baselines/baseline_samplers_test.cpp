// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "baselines/baseline_samplers.h"
#include "support/kinds.h"
#include "support/planar_memory.h"

namespace mneme::test {
namespace {

struct TwoRows {
  Robot robot = planar8();
  TemporaryDirectory directory;
  Database database = make_database(directory / "m.db", robot);
  std::vector<PrimitiveKey> keys = {near_pair(), make_primitive({6, 1.4, 1.2, 6.4, -1.5, 1.3}).key};
  TwoRows() { learn_into(database, robot, keys); }
  [[nodiscard]] Problem problem(const Scene& scene) const {
    return {"", robot, "", scene, Configuration(8, 0.0), {Configuration(8, 0.1)}, {}};
  }
  [[nodiscard]] int components(std::int64_t row) const {
    return database.get(row)->sampler().component_count();
  }
};

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("the pooled sampler is all components as they were learned") {
    TwoRows memory;
    REQUIRE(memory.components(0) > 0);
    const Problem problem = memory.problem({});
    const GaussianMixture pooled = *internal::pool_all(
        *internal::make_query(problem, &memory.database, {}), memory_query(problem));
    CHECK(pooled.component_count() == memory.components(0) + memory.components(1));
    CHECK(memory.robot.distance(mean_of(pooled, 0), mean_of(memory.database.get(0)->sampler(), 0)) <
          1e-5);
  }

  TEST_CASE("remembered paths are pooled as a component at each waypoint") {
    TwoRows memory;
    const Problem problem = memory.problem({});
    const Path path = {problem.start, Configuration(8, 0.05), problem.goals[0]};
    REQUIRE(memory.database.insert(learn_whole_paths(memory.robot, std::vector<Path>{path})));
    const auto pooled = require(internal::pool_all(
        *internal::make_query(problem, &memory.database, {}), memory_query(problem)));
    CHECK(pooled.component_count() == memory.components(0) + memory.components(1) + 3);
  }

  TEST_CASE("the nearest scene is the one that was learned, whichever way it is turned") {
    TwoRows memory;
    SolveSettings settings;
    settings.max_matches = 1;
    for (std::size_t row = 0; row < 2; ++row) {
      for (const double rotation : {0.0, 1.2, -2.5}) {
        const Scene scene = make_scene(moved_key({rotation, false}, memory.keys[row]));
        const Problem problem = memory.problem(scene);
        const auto mixture = require(internal::recall_nearest_scenes(
            *internal::make_query(problem, &memory.database, settings), memory_query(problem)));
        const LocalSampler learned = memory.database.get(static_cast<std::int64_t>(row))->sampler();
        REQUIRE(mixture.component_count() == learned.component_count());
        const Configuration turned =
            moved_configuration({0, -1}, {rotation, false}, mean_of(learned, 0));
        CHECK(memory.robot.distance(mean_of(mixture, 0), turned) < 1e-4);
      }
    }
  }

  TEST_CASE("a scene without circles has no neighbours, and other solids are an error") {
    TwoRows memory;
    const SolveSettings settings;
    const Problem nothing = memory.problem({});
    const auto empty = require(internal::recall_nearest_scenes(
        *internal::make_query(nothing, &memory.database, {}), memory_query(nothing)));
    CHECK(empty.component_count() == 0);
    const Scene box{"box", {{"box", {Box{{}, {0.1, 0.1, 0.1}}}}}};
    const Problem boxed = memory.problem(box);
    CHECK(!internal::recall_nearest_scenes(*internal::make_query(boxed, &memory.database, {}),
                                           memory_query(boxed)));
  }
}

TEST_SUITE("law") {
  TEST_CASE("the distance of scenes is symmetric, and 0 for the same circles in any order") {
    Rng rng(20264);
    for (int trial = 0; trial < 50; ++trial) {
      PrimitiveKey a, b;
      for (int i = 0; i < 9; ++i) a.push_back(rng.uniform(-5, 5));
      for (int i = 0; i < 6; ++i) b.push_back(rng.uniform(-5, 5));
      CHECK(internal::scene_distance(a, b) == doctest::Approx(internal::scene_distance(b, a)));
      CHECK(internal::scene_distance(a, b) > 0);
      PrimitiveKey turned = a;
      std::rotate(turned.begin(), turned.begin() + 3, turned.end());
      CHECK(internal::scene_distance(a, turned) == 0);
    }
  }
}

}  // namespace mneme::test
