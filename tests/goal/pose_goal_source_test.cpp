// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "goal/posed_robots.h"

#include <algorithm>

namespace mneme::test {
namespace {

CollisionChecker checker_among(const Robot& robot, const Scene& scene) {
  return require(CollisionChecker::make(robot, scene));
}

PoseGoalSource require_source(const CollisionChecker& checker, const std::vector<PoseGoal>& goals,
                              const IkSettings& settings = {}) {
  return require(PoseGoalSource::make(checker, goals, kReady, settings, 1e-4));
}

/// Where a random configuration has the hand, with any rotation.
PoseGoal random_place(const Robot& robot, Rng& rng) {
  Configuration q;
  for (int i = 0; i < robot.joint_count(); ++i) {
    q.push_back(rng.uniform(robot.group_joint(i).lower, robot.group_joint(i).upper));
  }
  PoseGoal goal = pose_at(robot, kHand, q);
  goal.cone = goal.turn = kPi;
  return goal;
}

/// Why `goal` cannot be reached in `scene`; it must not be reached.
std::string failure_of(const Scene& scene, const PoseGoal& goal) {
  const Robot robot = shipped_robot("panda");
  const CollisionChecker checker = checker_among(robot, scene);
  PoseGoalSource source = require_source(checker, {goal});
  CHECK(source.more().empty());
  return source.describe_failure();
}

TEST_SUITE("unit") {
  TEST_CASE("more and more goals come, all free and different, the nearest first") {
    const Robot robot = shipped_robot("panda");
    Scene scene;
    scene.obstacles.push_back({"ball", {Sphere{Vec3(0.3, -0.4, 0.5), 0.2}}});
    const CollisionChecker checker = checker_among(robot, scene);
    const PoseGoal first = pose_at(robot, kHand, {0.3, 0.2, 0.1, -1.8, 0, 2, 0.5});
    const PoseGoal second = pose_at(robot, kHand, {-0.5, 0.3, 0.1, -1.5, 0, 2, 0.5});
    PoseGoalSource source = require_source(checker, {first, second});
    std::vector<Configuration> all = source.more();
    REQUIRE(all.size() >= 2);
    CHECK(std::ranges::is_sorted(
        all, {}, [&](const Configuration& q) { return robot.distance(kReady, q); }));
    const std::size_t at_once = all.size();
    for (int i = 0; i < 6; ++i) {
      for (Configuration& q : source.more()) all.push_back(std::move(q));
    }
    CHECK(all.size() > at_once);
    int of_second = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      CHECK(checker.is_valid(std::span<const double>(all[i])));
      const bool is_first = pose_error(robot, first, all[i]).position < 1e-4;
      const bool is_second = pose_error(robot, second, all[i]).position < 1e-4;
      CHECK(is_first != is_second);
      of_second += is_second;
      for (std::size_t k = 0; k < i; ++k) CHECK(robot.distance(all[i], all[k]) >= 0.1);
    }
    CHECK(of_second > 0);
    CHECK(of_second < static_cast<int>(all.size()));
  }

  TEST_CASE("a goal that nothing reaches says why") {
    const Robot robot = shipped_robot("panda");
    PoseGoal goal = pose_at(robot, kHand, kReady);
    SUBCASE("out of reach") {
      goal.pose.translation = Vec3(1.5, 0, 0.3);
      const std::string failure = failure_of({}, goal);
      CHECK_MESSAGE(
          failure.starts_with("goal pose: the pose is out of reach of link 'panda_hand' by "),
          failure);
      CHECK(failure.ends_with(" cm"));
      goal.pose.translation = Vec3(11.5, 0, 0.3);
      const std::string far = failure_of({}, goal);
      CHECK_MESSAGE(far.ends_with(" by 10.64 m"), far);
    }
    SUBCASE("only in contact") {
      Scene scene;
      scene.obstacles.push_back({"table", {Sphere{goal.pose.translation, 0.1}}});
      CHECK(failure_of(scene, goal) ==
            "goal pose: link 'panda_hand' reaches the pose only in contact with obstacle 'table' "
            "(2048 "
            "seeds tried)");
    }
    SUBCASE("not with that rotation") {
      // Back towards the base from almost as far as it reaches.
      goal.pose.translation = Vec3(0.75, 0, 0.333);
      goal.pose.rotation = rotation_from_rpy(Vec3(0, -kPi / 2, 0));
      const std::string failure = failure_of({}, goal);
      CHECK_MESSAGE(
          failure.starts_with("goal pose: link 'panda_hand' reaches this position, but not "
                              "this rotation: no solution from 2048 seeds, "),
          failure);
    }
  }

  TEST_CASE("of several goals those that nothing reaches are told") {
    const Robot robot = shipped_robot("panda");
    const CollisionChecker checker = checker_among(robot, {});
    const PoseGoal near = pose_at(robot, kHand, kReady);
    PoseGoal far = near;
    far.pose.translation = Vec3(11.5, 0, 0.3);
    PoseGoalSource source = require_source(checker, {near, far}, {});
    CHECK_FALSE(source.more().empty());
    const std::vector<std::string> unreached = source.describe_unreached();
    REQUIRE(unreached.size() == 1);
    CHECK_MESSAGE(unreached[0].starts_with("goal pose 1: no configuration from 2048 seeds, the "
                                           "closest is 10."),
                  unreached[0]);
  }

  TEST_CASE("a search that is over looks no further, and says so") {
    const Robot robot = shipped_robot("panda");
    const CollisionChecker checker = checker_among(robot, {});
    PoseGoal unreachable = pose_at(robot, kHand, kReady);
    unreachable.pose.translation = Vec3(1.5, 0, 0.3);
    IkSettings settings;
    settings.seeds = 100000000;
    int asked = 0;
    settings.is_over = [&] { return asked++ >= 3; };
    CHECK(
        require(InverseKinematics::make(robot, kHand)).solve(unreachable, kReady, settings).seeds ==
        48);
    CHECK(
        require(InverseKinematics::make(robot, kHand)).solve(unreachable, kReady, settings).seeds ==
        0);
    asked = 0;
    PoseGoalSource source = require_source(checker, {unreachable, unreachable}, settings);
    CHECK(source.more().empty());
    CHECK(source.describe_failure() ==
          "goal pose 0: the search for link 'panda_hand' ended after 48 seeds; goal pose 1: the "
          "search for link 'panda_hand' ended after 0 seeds");
  }

  TEST_CASE("to say why a goal cannot be reached takes few seeds") {
    const Robot robot = shipped_robot("panda");
    const CollisionChecker checker = checker_among(robot, {});
    PoseGoal unreachable = pose_at(robot, kHand, kReady);
    unreachable.pose.translation = Vec3(1.5, 0, 0.3);
    IkSettings settings;
    settings.seeds = 4096;
    int asked = 0;
    settings.is_over = [&] { return ++asked < 0; };
    PoseGoalSource source = require_source(checker, {unreachable}, settings);
    CHECK(source.more().empty());
    CHECK(asked == 256);
    CHECK(contains(source.describe_failure(), "out of reach"));
    CHECK(asked <= 256 + 64);
  }

  TEST_CASE("of many goals the first solutions come at once, and the others meanwhile") {
    const Robot robot = shipped_robot("panda");
    const CollisionChecker checker = checker_among(robot, {});
    Rng rng(4);
    std::vector<PoseGoal> goals;
    for (int i = 0; i < 500; ++i) goals.push_back(random_place(robot, rng));
    IkSettings settings;
    int batches = 0;
    settings.is_over = [&] { return ++batches < 0; };
    PoseGoalSource source = require_source(checker, goals, settings);
    std::vector<Configuration> found = source.more();
    CHECK(std::ssize(found) == settings.solutions);
    CHECK(batches < 100);
    REQUIRE(source.describe_unreached().size() == 1);
    CHECK(source.describe_unreached()[0].starts_with(
        "planning began with configurations for 8 of 500 goal poses; "));
    for (int i = 0; i < 20; ++i) {
      const int before = batches;
      for (Configuration& q : source.more()) found.push_back(std::move(q));
      CHECK(batches - before < 150);
    }
    std::size_t reached = 0;
    for (const PoseGoal& goal : goals) {
      reached += std::ranges::any_of(found, [&](const Configuration& q) {
        return pose_error(robot, goal, q).position < 1e-4;
      });
    }
    CHECK(reached > 80);
  }

  TEST_CASE("the only goals of many that can be reached are found, and the clock is looked at") {
    const Robot robot = shipped_robot("panda");
    const CollisionChecker checker = checker_among(robot, {});
    PoseGoal unreachable = pose_at(robot, kHand, kReady);
    unreachable.pose.translation = Vec3(1.5, 0, 0.3);
    std::vector<PoseGoal> goals(300, unreachable);
    goals.push_back(pose_at(robot, kHand, {0.3, 0.2, 0.1, -1.8, 0, 2, 0.5}));
    IkSettings settings;
    int batches = 0, most = 1'000'000;
    settings.is_over = [&] { return ++batches > most; };
    CHECK(require_source(checker, goals, settings).more().size() == 1);
    CHECK(batches < 3000);
    batches = 0;
    most = 100;
    PoseGoalSource ended = require_source(checker, goals, settings);
    CHECK(ended.more().empty());
    CHECK(batches < 110);
    CHECK(ended.describe_failure().ends_with("; no configuration for 293 more goal poses"));
  }

  TEST_CASE("an unknown link is an error") {
    const Robot robot = shipped_robot("panda");
    const CollisionChecker checker = checker_among(robot, {});
    PoseGoal goal;
    goal.link = "nose";
    const Error error = require_error(PoseGoalSource::make(checker, {&goal, 1}, kReady, {}, 0));
    CHECK(error.message == "expected a link of robot panda, got \"nose\"");
  }
}

}  // namespace
}  // namespace mneme::test
