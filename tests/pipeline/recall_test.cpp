// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/kinds.h"
#include "support/lifting_arm.h"
#include "support/planar_memory.h"

namespace mneme::test {
namespace {

GlSampler create(const Robot& robot, const Scene& scene, Database& database,
                 const SolveSettings& settings) {
  auto gl = require(recall(problem_in(robot, scene), database, settings));
  REQUIRE(gl.mixture != nullptr);
  return gl;
}

SolveSettings learning_settings(double budget_s = 60) {
  SolveSettings settings;
  settings.learn_budget_s = budget_s;
  settings.learn = cheap_settings();
  return settings;
}

/// The pair twice, the second time turned about the base.
Scene pair_twice() {
  Scene scene = make_scene(near_pair());
  for (Obstacle obstacle : make_scene(moved_key({2, true}, near_pair())).obstacles) {
    obstacle.name += " again";
    scene.obstacles.push_back(obstacle);
  }
  return scene;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a hit changes nothing in the database") {
    const Robot robot = planar8();
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", robot);
    learn_into(database, robot, keys_near(near_pair(), 4, 0.05, 1));
    const std::int64_t components = database.info().components;
    const GlSampler gl = create(robot, make_scene(near_pair()), database, learning_settings());
    REQUIRE(gl.primitives.size() == 1);
    CHECK(gl.primitives[0].matches.size() == 4);
    CHECK(!gl.primitives[0].is_learned);
    CHECK(gl.mixture->component_count() == components);
    CHECK(gl.learning_time_s == 0);
    CHECK(gl.retrieval_time_s > 0);
    CHECK(database.size() == 4);
    CHECK(database.info().components == components);
    // So that a database that may only be read will do.
    Database reader = make_database(directory / "a.db", robot, OpenMode::read_only);
    const GlSampler same = create(robot, make_scene(near_pair()), reader, learning_settings());
    CHECK(same.mixture->means == gl.mixture->means);
  }

  TEST_CASE("a miss is learned within the budget, inserted and used, and then is a hit") {
    const Robot robot = planar8();
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", robot);
    const Scene scene = make_scene(moved_key({1, true}, near_pair()));
    const GlSampler gl = create(robot, scene, database, learning_settings());
    REQUIRE(gl.primitives.size() == 1);
    CHECK(gl.primitives[0].is_learned);
    REQUIRE(gl.primitives[0].matches.size() == 1);
    CHECK(gl.primitives[0].matches[0].similarity_error < 1e-9);
    CHECK(gl.mixture->component_count() > 0);
    CHECK(gl.learning_time_s > 0);
    REQUIRE(database.size() == 1);
    CHECK(database.get(0)->key == gl.primitives[0].primitive.key);
    CHECK(!database.get(0)->provenance.settings.empty());

    const GlSampler again = create(robot, scene, database, learning_settings());
    CHECK(!again.primitives[0].is_learned);
    CHECK(again.mixture->means == gl.mixture->means);
    CHECK(database.size() == 1);
    // It is there for the next process too.
    const Database reopened = make_database(directory / "a.db", robot, OpenMode::read_only);
    CHECK(reopened.size() == 1);
  }

  TEST_CASE("a threshold that lets hardly anything through lets the same key through") {
    const Robot robot = planar8();
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", robot);
    SolveSettings settings = learning_settings();
    settings.similarity = 1e-300;
    for (int round = 0; round < 3; ++round) {
      const GlSampler gl = create(robot, make_scene(near_pair()), database, settings);
      CHECK(gl.primitives[0].is_learned == (round == 0));
      CHECK(gl.primitives[0].matches.size() == 1);
      CHECK(gl.mixture->component_count() == database.info().components);
      CHECK(database.size() == 1);
    }
    // Without a budget too, but nothing that differs.
    settings.learn_budget_s = 0;
    CHECK(create(robot, make_scene(near_pair()), database, settings).primitives[0].matches.size() ==
          1);
    PrimitiveKey other = near_pair();
    other[2] += 1e-6;
    CHECK(create(robot, make_scene(other), database, settings).primitives[0].matches.empty());
  }

  TEST_CASE("more samples are free once components are fitted to the scene's gap") {
    const Robot robot = planar8();
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", robot);
    learn_into(database, robot, keys_near(near_pair(), 4, 0.2, 1));
    const Scene scene = make_scene(near_pair());
    const Problem problem = problem_in(robot, scene);
    const CollisionChecker checker = make_checker(robot, scene);
    SolveSettings settings;
    settings.lambda = 1;
    settings.sigma = 1e-4;
    settings.retrieve_after = 0;
    settings.drop_invalid_means = false;
    const auto count_free = [&](bool is_fitted) {
      settings.retarget = is_fitted;
      const auto sampler = require(make_sampler(problem, &database, settings));
      const auto samples = sampler->start(1);
      std::vector<float> q(8);
      int count = 0;
      for (int i = 0; i < 1000; ++i) {
        samples->next(q);
        count += checker.is_valid(Configuration(q.begin(), q.end())) ? 1 : 0;
      }
      return count;
    };
    CHECK(count_free(true) > count_free(false));
  }

  TEST_CASE("a miss without a budget leaves sampler and database empty") {
    const Robot robot = planar8();
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", robot);
    const GlSampler gl = create(robot, make_scene(near_pair()), database, {});
    REQUIRE(gl.primitives.size() == 1);
    CHECK(gl.primitives[0].matches.empty());
    CHECK(!gl.primitives[0].is_learned);
    CHECK(gl.mixture->component_count() == 0);
    CHECK(gl.mixture->joint_count == 8);
    CHECK(gl.learning_time_s == 0);
    CHECK(database.size() == 0);
  }

  TEST_CASE("a primitive that another one of the scene resembles is learned once for both") {
    const Robot robot = planar8();
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", robot);
    const GlSampler gl = create(robot, pair_twice(), database, learning_settings());
    REQUIRE(gl.primitives.size() == 2);
    CHECK(gl.primitives[0].is_learned);
    CHECK(!gl.primitives[1].is_learned);
    CHECK(database.size() == 1);
    REQUIRE(gl.primitives[1].matches.size() == 1);
    CHECK(gl.primitives[1].matches[0].experience == gl.primitives[0].matches[0].experience);
    const int stored = database.get(0)->sampler().component_count();
    REQUIRE(gl.mixture->component_count() == 2 * stored);
    REQUIRE(gl.mixture->sources.size() == static_cast<std::size_t>(2 * stored));
    CHECK(gl.mixture->sources.front() == 0);
    CHECK(gl.mixture->sources.back() == 1);
  }

  TEST_CASE("budgets are shared by all primitives of a scene") {
    const Robot robot = planar8();
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", robot);
    constexpr double kBudget = 0.2 * kSlowdown;
    SolveSettings settings = learning_settings(kBudget);
    settings.learn.starts_per_link = 1000;
    settings.learn.paths_per_start = 1000;
    settings.similarity = 1e-6;
    Scene scene =
        make_circle_scene("", {{3, 1.4, 1.2}, {3.4, -1.5, 1.3}, {-3, 1.5, 1.2}, {-3, -1.3, 1.2}});
    const GlSampler gl = create(robot, scene, database, settings);
    REQUIRE(gl.primitives.size() == 2);
    // The first one takes it all.
    CHECK(gl.learning_time_s >= kBudget);
    CHECK(gl.primitives[0].is_learned);
    CHECK(!gl.primitives[1].is_learned);
  }

  TEST_CASE("settings out of range are refused by name") {
    const Robot robot = planar8();
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", robot);
    SolveSettings wrong;
    wrong.sigma = -1.0;
    const auto gl = recall(problem_in(robot, make_scene(near_pair())), database, wrong);
    REQUIRE(!gl.has_value());
    CHECK(gl.error().code == ErrorCode::invalid);
    CHECK(contains(gl.error().message, "'sigma'"));
  }

  TEST_CASE("a pair of bodies is not learned on a miss as if it were one of circles") {
    const Robot robot = planar8();
    const TemporaryDirectory directory;
    Database database =
        Database::open(directory / "a.db", make_signature(robot), OpenMode::create).value();
    SolveSettings settings = learning_settings();
    settings.memory.kind = "body_pairs";
    settings.memory.max_gap = 5;
    const Scene scene = make_scene(near_pair());
    const Error refused = require_error(recall(problem_in(robot, scene), database, settings));
    CHECK(contains(refused.message, "cannot learn while planning"));
    settings.learn_budget_s = 0;
    const GlSampler gl = create(robot, scene, database, settings);
    REQUIRE(gl.primitives.size() == 1);
    CHECK(gl.primitives[0].primitive.key.size() == 18);
    CHECK(database.size() == 0);
  }

  TEST_CASE("at most so many matches are used") {
    const Robot robot = planar8();
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", robot);
    learn_into(database, robot, keys_near(near_pair(), 12, 0.05, 2));
    SolveSettings settings;
    for (const int most : {1, 3, 8, 12, 100, 1000000}) {
      settings.max_matches = most;
      const GlSampler gl = create(robot, make_scene(near_pair()), database, settings);
      const auto& matches = gl.primitives.at(0).matches;
      CHECK(static_cast<int>(matches.size()) == std::min(most, 12));
      int components = 0;
      for (std::size_t i = 0; i < matches.size(); ++i) {
        components += matches[i].experience->sampler().component_count();
        if (i > 0) CHECK(matches[i].similarity_error >= matches[i - 1].similarity_error);
      }
      CHECK(gl.mixture->component_count() == components);
    }
  }

  TEST_CASE("only what is more similar than the threshold is used") {
    const Robot robot = planar8();
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", robot);
    const auto keys = keys_near(near_pair(), 15, 0.4, 3);
    learn_into(database, robot, keys);
    SolveSettings settings;
    settings.max_matches = 1000000;
    std::size_t previous = 0;
    for (const double threshold : {1e-9, 0.1, 0.3, 5.0}) {
      settings.similarity = threshold;
      const GlSampler gl = create(robot, make_scene(near_pair()), database, settings);
      std::size_t expected = 0;
      for (const PrimitiveKey& key : keys) expected += pair_error(key, near_pair()) < threshold;
      const auto& matches = gl.primitives.at(0).matches;
      CHECK(matches.size() == expected);
      for (const Match& match : matches) {
        CHECK(match.similarity_error < threshold);
        CHECK(match.similarity_error ==
              doctest::Approx(pair_error(match.experience->key, near_pair())));
      }
      CHECK(matches.size() >= previous);
      previous = matches.size();
    }
    CHECK(previous == 15);
  }

  TEST_CASE("a scene without pairs has an empty sampler") {
    const Robot robot = planar8();
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", robot);
    const GlSampler gl = create(robot, make_circle_scene("", {{3, 3, 1}, {-3, -3, 1}}), database,
                                learning_settings());
    CHECK(gl.primitives.empty());
    CHECK(gl.mixture->component_count() == 0);
    CHECK(database.size() == 0);
    SolveSettings wide;
    wide.memory.max_gap = 10;
    CHECK(create(robot, make_circle_scene("", {{3, 3, 1}, {-3, -3, 1}}), database, wide)
              .primitives.size() == 1);
  }

  TEST_CASE("a database of another robot is refused, however it was opened") {
    const Robot robot = planar8(), other = planar_arm({3, 3, 3});
    const TemporaryDirectory directory;
    {
      Database foreign = make_database(directory / "a.db", other);
      learn_into(foreign, other, {near_pair()});
    }
    auto database = require(Database::inspect(directory / "a.db"));
    const Scene scene = make_scene(near_pair());
    const Error error = require_error(recall(problem_in(robot, scene), database, {}));
    CHECK(error.code == ErrorCode::wrong_robot);
    for (const std::string& part :
         {directory / "a.db", other.kinematics_hash(), robot.kinematics_hash()}) {
      CHECK_MESSAGE(contains(error.message, part), error.message);
    }
    CHECK(create(other, make_scene(near_pair()), database, {}).primitives.size() == 1);
  }

  TEST_CASE("an empty file that is only looked at is of every robot") {
    const TemporaryDirectory directory;
    write_file(directory / "a.db", "");
    auto database = require(Database::inspect(directory / "a.db"));
    CHECK(create(planar8(), make_scene(near_pair()), database, {}).mixture->component_count() == 0);
  }

  TEST_CASE("a scene that cannot be decomposed is an error that names the obstacle") {
    const Robot robot = planar8();
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", robot);
    const Scene scene{"", {{"crate", {box_at({20, 0, 0}, {1, 1, 1})}}}};
    const Error error = require_error(recall(problem_in(robot, scene), database, {}));
    CHECK(contains(error.message, "'crate'"));
    SolveSettings unknown;
    unknown.memory.kind = "triples";
    const Scene pair = make_scene(near_pair());
    const Error refused = require_error(recall(problem_in(robot, pair), database, unknown));
    CHECK(contains(refused.message, "triples"));
  }
}

}  // namespace mneme::test
