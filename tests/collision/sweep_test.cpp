// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/small_worlds.h"
#include "collision/sweeps.h"

namespace mneme::test {
TEST_SUITE("unit") {
  TEST_CASE("a link that dips into another one between two free states is found") {
    const Robot robot = thick_arm({1, 0.5, 0.35});
    const CollisionChecker checker = make_checker(robot, {});
    const Configuration left = {0, 2.4, 1.5}, right = {0, 2.4, 3.0}, up = {1, 2.4, 0.2};
    for (const Configuration& q : {left, right, up}) REQUIRE(checker.contacts(q).empty());
    CHECK(is_swept_free(checker, left, up));
    CHECK_FALSE(is_swept_free(checker, left, right));
    CHECK_FALSE(is_swept_free(checker, right, left));
    CHECK_FALSE(is_swept_free(checker, up, right));
  }

  TEST_CASE("where links are known to keep apart only obstacles are looked at") {
    const Robot robot = thick_arm({1, 0.5, 0.35});
    const Configuration left = {0, 2.4, 1.5}, right = {0, 2.4, 3.0};
    const SweepDetail apart{.are_links_apart = true};
    CHECK_FALSE(is_swept_free(robot, {}, left, right));
    CHECK(is_swept_free(robot, {}, left, right, apart));
    CHECK(is_swept_free(robot, make_circle_scene("", {{1.2, 1, 0.05}}), left, right, apart));
    CHECK_FALSE(
        is_swept_free(robot, make_circle_scene("", {{0.62, 0.12, 0.02}}), left, right, apart));
  }

  TEST_CASE("an obstacle thinner than the step between two states is found") {
    const Robot robot = thick_arm({1, 1});
    const Scene thin = make_circle_scene("", {{1.5, 0, 1e-4}});
    CHECK_FALSE(is_swept_free(robot, thin, Configuration{-1, 0}, Configuration{1.1, 0}));
    CHECK(is_swept_free(robot, thin, Configuration{0.1, 0}, Configuration{1.1, 0}));
    // A continuous joint takes the shorter way, past pi.
    CHECK(is_swept_free(robot, thin, Configuration{-2, 0}, Configuration{2, 0}));
  }

  TEST_CASE("an obstacle that a link may touch is no contact of this link") {
    const Robot robot = thick_arm({1, 1});
    Scene thin = make_circle_scene("", {{1.5, 0, 1e-4}});
    thin.obstacles[0].may_touch = {robot.links()[1].name};
    CHECK_FALSE(is_swept_free(robot, thin, Configuration{-1, 0}, Configuration{1.1, 0}));
    thin.obstacles[0].may_touch = {robot.links()[2].name};
    CHECK(is_swept_free(robot, thin, Configuration{-1, 0}, Configuration{1.1, 0}));
  }

  TEST_CASE("a little gap passes, a little contact does not") {
    const Robot robot = thick_arm({1, 1});
    const auto is_free = [&](double overlap) {
      const Scene scene = make_circle_scene("", {{2 + 0.01 + 0.5 - overlap, 0, 0.5}});
      return is_swept_free(robot, scene, Configuration{-0.3, 0}, Configuration{0.3, 0});
    };
    CHECK(is_free(-1e-4));
    CHECK_FALSE(is_free(kSweepTolerance));
    // An end counts like all else.
    for (double overlap = kSweepTolerance; overlap < 1e-4; overlap *= 1.1) {
      const Scene scene{"", {make_ball("ball", {1, 0, 0}, 0.2)}};
      const Configuration end = {1 - 0.3 + overlap, 0, 0};
      CHECK_FALSE(is_swept_free(gantry(), scene, Configuration{-1.234, 0, 0}, end));
    }
  }

  TEST_CASE("closer to an obstacle than the checker's margin is contact, to a link it is not") {
    const Robot robot = thick_arm({1, 1});
    const auto checker_of = [](const Robot& arm, const Scene& scene, double margin) {
      return require_checker(arm, scene, {.margin = margin});
    };
    const Scene scene = make_circle_scene("", {{2 + 0.01 + 0.5 + 0.01, 0, 0.5}});
    const Configuration low = {-0.3, 0}, high = {0.3, 0};
    CHECK(is_swept_free(checker_of(robot, scene, 0.009), low, high));
    CHECK_FALSE(is_swept_free(checker_of(robot, scene, 0.011), low, high));
    const Robot folded = thick_arm({1, 0.5, 0.35});
    CHECK(is_swept_free(checker_of(folded, {}, 0.5), Configuration{0, 2.4, 1.5},
                        Configuration{1, 2.4, 0.2}));
  }

  TEST_CASE("the margin of a sweep holds to obstacles and links, but next to the path's ends") {
    const Scene scene = make_circle_scene("", {{2 + 0.01 + 0.5 + 5e-5, 0, 0.5}});
    const CollisionChecker checker = require_checker(thick_arm({1, 1}), scene);
    const Configuration touching = {0, 0}, away = {0.5, 0.5};
    CHECK(is_swept_free(checker, touching, away));
    CHECK_FALSE(is_swept_free(checker, touching, away, {1e-4, false, false}));
    CHECK_FALSE(is_swept_free(checker, touching, away, {1e-4, false, true}));
    CHECK(is_swept_free(checker, touching, away, {1e-4, true, false}));
    CHECK(is_swept_free(checker, away, touching, {1e-4, false, true}));
    // Far from the ends it holds.
    CHECK_FALSE(is_swept_free(checker, Configuration{-0.3, 0}, {0.3, 0}, {1e-4, true, true}));
    const Robot folded = thick_arm({1, 0.5, 0.35});
    const CollisionChecker alone = require_checker(folded, {});
    double least = 1;
    for (double gap = 1e-3; gap < 0.5; gap *= 1.2) {
      if (!is_swept_free(alone, {0, 2.4, 1.5}, {1, 2.4, 0.2}, {gap, false, false})) {
        least = std::min(least, gap);
      }
    }
    CHECK(least < 0.5);
  }

  TEST_CASE("next to an end that is exempt from the margin nothing thin is missed") {
    const Robot robot = require_parsed(R"(<robot name="needle"><link name="base"/>
      <link name="tip"><collision><geometry><sphere radius="1.5e-5"/></geometry></collision></link>
      <joint name="slide" type="prismatic"><parent link="base"/><child link="tip"/>
        <axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>)");
    for (double way = 2e-4; way < 5e-3; way *= 1.1) {
      const Scene scene{"", {make_ball("grain", {way, 0, 0}, 1.5e-5)}};
      const CollisionChecker checker = require_checker(robot, scene);
      INFO("after " << way << " m");
      CHECK_FALSE(is_swept_free(checker, Configuration{0}, {0.5}, {1e-4, true, false}));
      CHECK_FALSE(is_swept_free(checker, Configuration{0.5}, {0}, {1e-4, false, true}));
    }
  }

  TEST_CASE("sliding joints count by how far they slide") {
    const World world{"post", gantry(), {"", {make_ball("post", {0.01, 0, 0}, 0.001)}}, {}};
    const CollisionChecker checker = require_checker(world.robot, world.scene);
    CHECK_FALSE(is_swept_free(checker, Configuration{-2, 0, 0}, Configuration{2, 0, 0}));
    CHECK(is_swept_free(checker, Configuration{-2, 0, 0.5}, Configuration{2, 0, 0.5}));
  }
}

TEST_SUITE("oracle") {
  TEST_CASE(
      "a sweep is free if no state of a dense row is in contact, but for contact between two of "
      "them") {
    constexpr std::uint64_t kSeed = 81;
    constexpr int kStates = 4000;
    Rng rng(kSeed);
    const Robot arm = thick_arm({1, 0.7, 0.5, 0.4});
    const World space = boxed_goal();
    SweepTally tally;
    for (int i = 0; i < 150; ++i) {
      INFO("seed " << kSeed << ", motion " << i);
      const bool is_planar = i % 3 != 0;
      const Robot& robot = is_planar ? arm : space.robot;
      const Scene scene =
          is_planar ? make_circle_scene("", {{rng.uniform(-2, 2), rng.uniform(0.5, 2), 0.2}})
                    : space.scene;
      const CollisionChecker checker = make_checker(robot, scene);
      const Configuration from = random_configuration(robot, rng);
      Configuration to = random_configuration(robot, rng);
      for (std::size_t j = 0; j < to.size(); ++j) to[j] = from[j] + 0.8 * (to[j] - from[j]);
      if (!checker.contacts(from).empty() || !checker.contacts(to).empty()) continue;
      tally.compare(checker, from, to, kStates);
    }
    CHECK(tally.refused <= 1);
    CHECK(tally.free > 5);
    CHECK(tally.blocked > 5);
  }
}

}  // namespace mneme::test
