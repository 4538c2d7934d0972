// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/pipeline.h"

#include "support/kinds.h"
#include "support/planar_memory.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace mneme::test {
namespace {

double key_distance(const PrimitiveKey& a, const PrimitiveKey& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

PrimitiveKey key_of(const Robot& robot, const Configuration& start, const Configuration& goal) {
  return make_query_primitive(robot, start, goal).key;
}

Experience remember(const Robot& robot, const Path& path) {
  return learn_whole_paths(robot, std::vector<Path>{path}).front();
}

GaussianMixture warp(const Robot& robot, const Configuration& start, const Configuration& goal,
                     const std::vector<const Experience*>& rows) {
  std::vector<PrimitiveRetrieval> retrievals(1);
  for (const Experience* row : rows) {
    retrievals[0].matches.push_back({std::make_shared<const Experience>(*row), 0, {}});
  }
  const std::vector<Configuration> goals = {goal};
  return kind_named("paths").synthesize({robot, Scene{}, &start, goals}, retrievals);
}

void check_row(const GaussianMixture& mixture, int row, const Configuration& expected) {
  for (std::size_t j = 0; j < expected.size(); ++j) {
    const std::size_t at = static_cast<std::size_t>(row) * expected.size() + j;
    CHECK(mixture.means.at(at) == doctest::Approx(expected[j]).epsilon(1e-5));
  }
}

struct PathMemory {
  Problem problem = planar_problem("threaded_b4");
  TemporaryDirectory directory;
  Database database =
      Database::open(directory / "m.db", make_signature(problem.robot), OpenMode::create).value();

  void remember(const std::vector<Path>& paths) {
    require(database.insert(learn_whole_paths(problem.robot, paths)));
  }
  [[nodiscard]] GlSampler recall(const SolveSettings& settings = {}) {
    SolveSettings of_paths = settings;
    of_paths.memory.kind = "paths";
    return test::recall(problem, database, of_paths).value();
  }
};

Path bent(const Configuration& start, const Configuration& goal, double bend) {
  Configuration middle;
  for (std::size_t i = 0; i < start.size(); ++i) {
    middle.push_back(0.5 * (start[i] + goal[i]) + bend);
  }
  return {start, middle, goal};
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("the key of a query holds its length and both ends, a continuous joint as a point") {
    const Robot robot = planar_arm({1, 1});
    const PrimitiveKey key = key_of(robot, {0, 1}, {kPi / 2, 2});
    REQUIRE(static_cast<int>(key.size()) == query_key_size(robot));
    const PrimitiveKey expected = {std::sqrt(3.0), 1, 0, 1, 0, 1, 2};
    CHECK(key_distance(key, expected) < 1e-12);
  }

  TEST_CASE("queries under other constraints, or none, are told apart") {
    const Robot robot = planar_arm({1, 1});
    const OrientationConstraint cup{"link_1", Vec3::UnitZ(), Vec3::UnitZ(), 0.2};
    OrientationConstraint wide = cup, tip = cup;
    wide.angle = 0.3;
    tip.link = "link_2";
    const auto query = [&](const std::vector<OrientationConstraint>& constraints) {
      return make_query_primitive(robot, std::vector{0.0, 1.0}, std::vector{1.0, 0.0}, constraints);
    };
    CHECK(query({cup}).key == query({}).key);
    CHECK(query({}).constraints == 0);
    CHECK(query({cup}).constraints == query({cup}).constraints);
    CHECK(query({cup, tip}).constraints == query({tip, cup}).constraints);
    const std::set<std::uint64_t> hashes = {query({}).constraints, query({cup}).constraints,
                                            query({wide}).constraints, query({tip}).constraints,
                                            query({cup, tip}).constraints};
    CHECK(hashes.size() == 5);
  }

  TEST_CASE("no obstacle belongs to the primitive of a query, and no symmetry moves it") {
    const LocalPrimitive primitive =
        make_query_primitive(planar_arm({1, 1}), std::vector{0.0, 1.0}, std::vector{1.0, 0.0});
    CHECK(primitive.obstacles.empty());
    CHECK(primitive.to_scene.rotation == 0);
    CHECK_FALSE(primitive.to_scene.is_mirrored);
  }
}

TEST_SUITE("law") {
  TEST_CASE("the images of a query's key are its own and that of the reverse query") {
    for (const Robot& robot : {planar8(), planar_arm({1, 1}), upright_arm()}) {
      Rng rng(3);
      for (int i = 0; i < 20; ++i) {
        const Configuration start = random_configuration(robot, rng);
        const Configuration goal = random_configuration(robot, rng);
        const std::vector<KeyImage> found = kind_named("paths").images(key_of(robot, start, goal));
        REQUIRE(found.size() == 2);
        CHECK(found[0].key == key_of(robot, start, goal));
        CHECK(found[1].key == key_of(robot, goal, start));
        CHECK_FALSE(found[1].is_mirrored);
        CHECK(similarity_error(kind_named("paths"), found[0].key, found[1].key) == 0);
      }
    }
  }

  TEST_CASE("keys of queries are as far apart as their ends, through the seam of a joint too") {
    const Robot robot = planar_arm({1, 1});
    const PrimitiveKey key = key_of(robot, {kPi - 0.01, 1}, {0, 0});
    CHECK(similarity_error(kind_named("paths"), key, key_of(robot, {-kPi + 0.01, 1}, {0, 0})) ==
          doctest::Approx(0.0004).epsilon(0.01));
    CHECK(similarity_error(kind_named("paths"), key, key_of(robot, {kPi - 0.01, 1}, {0, 0.5})) >
          0.25);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("a waypoint moves with the ends in proportion to its place, and stays as it was too") {
    const Robot robot = planar_arm({1, 1});
    const Experience row = remember(robot, {{0, 0}, {0, 1}, {0, 4.0 / 3}, {0, 2}});
    const GaussianMixture mixture = warp(robot, {0.2, 0}, {0, 2.6}, {&row});
    REQUIRE(mixture.component_count() == 4);
    check_row(mixture, 0, {0.1, 1.3});
    check_row(mixture, 1, {0, 1});
    check_row(mixture, 2, {0.2 / 3, 4.0 / 3 + 0.4});
    check_row(mixture, 3, {0, 4.0 / 3});
  }

  TEST_CASE("a path that was remembered the other way round is turned round") {
    const Robot robot = planar_arm({1, 1});
    const Experience row = remember(robot, {{0, 2}, {0, 1}, {0, 0}});
    const GaussianMixture mixture = warp(robot, {0.2, 0}, {0, 2.6}, {&row});
    REQUIRE(mixture.component_count() == 2);
    check_row(mixture, 0, {0.1, 1.3});
  }

  TEST_CASE("a known task is bent near its ends alone, whichever way round it was remembered") {
    const Robot robot = planar_arm({1, 1, 1});
    const Path path = {{0, 0, 0}, {0.4, 1, 0}, {1, 1, 1}, {1, 2, 1}};
    const std::vector<Configuration> goal = {{1.06, 2.08, 1}};
    for (const bool is_reversed : {false, true}) {
      Path stored = path;
      if (is_reversed) std::ranges::reverse(stored);
      const Experience row = remember(robot, stored);
      const Path bent =
          kind_named("paths").bend({robot, Scene{}, &path.front(), goal}, goal.front(), row);
      REQUIRE(bent.size() == 5);
      CHECK(bent.front() == path.front());
      CHECK(bent.back() == goal.front());
      for (std::size_t i = 1; i < 3; ++i) CHECK(robot.distance(bent[i], path[i]) < 1e-6);
      // The goal is 0.1 away: what is more than 0.2 before it is as it was.
      const Configuration unmoved = {1, 1.8, 1};
      CHECK(robot.distance(bent[3], unmoved) < 1e-6);
    }
  }

  TEST_CASE("components stand in the order of the matches and count for their goal") {
    const Robot robot = planar_arm({1, 1});
    const Experience a = remember(robot, {{0, 0}, {0, 1}, {0, 2}});
    const Experience b = remember(robot, {{0, 0}, {1, 1}, {0, 2}});
    std::vector<PrimitiveRetrieval> retrievals(2);
    retrievals[0].matches = {{std::make_shared<const Experience>(b), 0, {}},
                             {std::make_shared<const Experience>(a), 1, {}}};
    retrievals[1].matches = {{std::make_shared<const Experience>(a), 0, {}}};
    const std::vector<Configuration> goals = {{0, 2}, {0, 4}};
    const Configuration start = {0, 0};
    const GaussianMixture mixture =
        kind_named("paths").synthesize({robot, Scene{}, &start, goals}, retrievals);
    CHECK(mixture.sources == std::vector<SampleSource>{0, 0, 0, 0, 1, 1});
    check_row(mixture, 0, {1, 1});
    check_row(mixture, 2, {0, 1});
    check_row(mixture, 4, {0, 2});
  }

  TEST_CASE("straight and motionless paths have nothing to add") {
    const Robot robot = planar_arm({1, 1});
    const Experience straight = remember(robot, {{0, 0}, {0, 2}});
    CHECK(warp(robot, {0, 0}, {0, 2}, {&straight}).component_count() == 0);
    const Experience still = remember(robot, {{0, 0}, {0, 0}, {0, 0}});
    const GaussianMixture mixture = warp(robot, {0, 0}, {0, 2}, {&still});
    for (const float value : mixture.means) CHECK(std::isfinite(value));
  }
}

TEST_SUITE("law") {
  TEST_CASE("warped waypoints stay within the limits, continuous joints within a turn") {
    const Robot robot = limited_arm({1, 1, 1}, -2, 2);
    Rng rng(5);
    for (int i = 0; i < 50; ++i) {
      const auto q = [&] { return random_configuration(robot, rng); };
      const Experience row = remember(robot, {q(), q(), q(), q()});
      const GaussianMixture mixture = warp(robot, q(), q(), {&row});
      REQUIRE(mixture.component_count() == 4);
      for (std::size_t k = 0; k < mixture.means.size(); ++k) {
        CHECK(std::abs(mixture.means[k]) <= (k % 3 == 0 ? kPi + 1e-5 : 2.0));
      }
    }
  }

  TEST_CASE("a query that is remembered exactly finds its own waypoints unmoved") {
    const Robot robot = planar8();
    Rng rng(6);
    Path path;
    for (int i = 0; i < 6; ++i) path.push_back(random_configuration(robot, rng));
    const Experience row = remember(robot, path);
    const GaussianMixture mixture = warp(robot, path.front(), path.back(), {&row});
    REQUIRE(mixture.component_count() == 8);
    for (int i = 1; i < 5; ++i) check_row(mixture, 2 * (i - 1), path[static_cast<std::size_t>(i)]);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("each path becomes a row with the key of its ends and its waypoints in their order") {
    const Robot robot = planar_arm({1, 1});
    const std::vector<Path> paths = {{{0, 0}, {0.5, 0.25}, {1, 1}}, {{1, -1}, {2, 2}}};
    const std::vector<Experience> rows = learn_whole_paths(robot, paths);
    REQUIRE(rows.size() == 2);
    CHECK(rows[0].path().waypoints == std::vector<float>{0, 0, 0.5, 0.25, 1, 1});
    CHECK(rows[1].path().waypoints == std::vector<float>{1, -1, 2, 2});
    for (std::size_t i = 0; i < rows.size(); ++i) {
      CHECK(rows[i].path().joint_count == 2);
      CHECK(rows[i].key == make_query_primitive(robot, paths[i].front(), paths[i].back()).key);
    }
  }

  TEST_CASE("no path teaches nothing, nor does one without a configuration") {
    const Robot robot = planar_arm({1, 1});
    CHECK(learn_whole_paths(robot, {}).empty());
    const std::vector<Path> paths = {{}, {{1, -1}, {2, 2}}, {}};
    const std::vector<Experience> rows = learn_whole_paths(robot, paths);
    REQUIRE(rows.size() == 1);
    CHECK(rows[0].path().waypoints == std::vector<float>{1, -1, 2, 2});
  }
}

TEST_SUITE("unit") {
  TEST_CASE("the paths of the most similar queries come first, at most max-matches of them") {
    PathMemory memory;
    const Configuration& start = memory.problem.start;
    const Configuration& goal = memory.problem.goals[0];
    Configuration near = goal, far = goal;
    near[3] += 0.1;
    far[3] += 0.4;
    memory.remember({bent(start, far, 0.1), bent(start, near, 0.2), bent(goal, start, 0.3)});
    SolveSettings settings;
    settings.max_matches = 2;
    const GlSampler gl = memory.recall(settings);
    REQUIRE(gl.primitives.size() == 1);
    REQUIRE(gl.primitives[0].matches.size() == 2);
    CHECK(gl.primitives[0].matches[0].similarity_error == doctest::Approx(0));
    CHECK(gl.primitives[0].matches[1].experience->id == 2);
    CHECK(gl.mixture->component_count() == 4);
    CHECK(memory.recall().mixture->component_count() == 6);
  }

  TEST_CASE("each goal is asked for") {
    PathMemory memory;
    const Configuration goal = memory.problem.goals[0];
    memory.problem.goals.push_back(memory.problem.start);
    memory.remember({bent(memory.problem.start, goal, 0.1)});
    const GlSampler gl = memory.recall();
    REQUIRE(gl.primitives.size() == 2);
    CHECK(gl.mixture->sources == std::vector<SampleSource>{0, 0, 1, 1});
  }

  TEST_CASE("an empty memory has nothing to say") {
    PathMemory memory;
    CHECK(memory.recall().mixture->component_count() == 0);
  }
}

TEST_SUITE("flow") {
  TEST_CASE(
      "without anchors and walks, a problem takes fewer samples once its paths are remembered") {
    PathMemory memory;
    SolveSettings settings;
    settings.sampler = "uniform";
    const SolveResult first = require_solved(memory.problem, nullptr, settings);
    memory.remember({first.plan.path});
    settings.sampler = "gl";
    settings.memory.kind = "paths";
    settings.retrieve_after = 0;
    settings.plan.anchor = 0;
    settings.plan.walk = 0;
    std::uint64_t with_memory = 0, without = 0;
    for (int seed = 2; seed < 7; ++seed) {
      settings.plan.seed = static_cast<std::uint64_t>(seed);
      const auto with = require(solve(memory.problem, &memory.database, settings));
      const auto uniform = require(solve(memory.problem, nullptr, settings));
      CHECK(with.plan.is_solved());
      CHECK(with.gl.primitives.size() == 1);
      with_memory += with.plan.iterations;
      without += uniform.plan.iterations;
    }
    CHECK(2 * with_memory < without);
  }

  TEST_CASE("a scene without a query cannot ask a memory of paths") {
    PathMemory memory;
    const Error error =
        require_error(decompose({memory.problem.robot, memory.problem.scene}, of_kind("paths")));
    CHECK(error.code == ErrorCode::invalid);
    CHECK(contains(error.message, "start and goal"));
  }
}

}  // namespace mneme::test
