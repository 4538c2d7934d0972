// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/planar_memory.h"

namespace mneme::test {
namespace {

Problem task() {
  Problem problem = planar_problem("threaded_b4");
  return problem;
}

Vec3 tip_of(const Robot& robot, const Configuration& q) {
  return robot.link_poses(q).back().translation;
}

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("a repeat moves each obstacle and the tip at the goal a little, and is free") {
    const Problem problem = task();
    Rng rng(1);
    for (int i = 0; i < 20; ++i) {
      const auto repeated = require(repeat(problem, {0.02, 0.03}, rng));
      CHECK(repeated.start == problem.start);
      REQUIRE(repeated.goals.size() == 1);
      const CollisionChecker checker = make_checker(problem.robot, repeated.scene);
      CHECK_FALSE(refuse_query(checker, {repeated.start, repeated.goals}).has_value());
      const Vec3 moved =
          tip_of(problem.robot, repeated.goals[0]) - tip_of(problem.robot, problem.goals[0]);
      CHECK(moved.norm() < 0.031);
      for (std::size_t k = 0; k < problem.scene.obstacles.size(); ++k) {
        const Vec3 from = bounding_sphere(problem.scene.obstacles[k].shapes[0]).center;
        const Vec3 to = bounding_sphere(repeated.scene.obstacles[k].shapes[0]).center;
        CHECK((to - from).norm() <= 0.02 + 1e-12);
        CHECK((to - from).norm() > 0);
      }
    }
  }

  TEST_CASE("where the base stands elsewhere, obstacles and the tip at the goal stay together") {
    const Problem problem = task();
    Rng rng(2);
    const auto middle_of = [](const Problem& of, std::size_t k) {
      return bounding_sphere(of.scene.obstacles[k].shapes[0]).center;
    };
    for (int i = 0; i < 20; ++i) {
      const auto repeated = require(repeat(problem, {0, 0, 0.2, 0.5}, rng));
      CHECK(repeated.start == problem.start);
      const Vec3 tip = tip_of(problem.robot, problem.goals[0]);
      const Vec3 moved = tip_of(problem.robot, repeated.goals[0]);
      CHECK(std::abs(moved.norm() - tip.norm()) <= 0.2 + 1e-3);
      for (std::size_t k = 0; k < problem.scene.obstacles.size(); ++k) {
        CHECK((middle_of(repeated, k) - moved).norm() ==
              doctest::Approx((middle_of(problem, k) - tip).norm()).epsilon(1e-3));
      }
      const Vec3 across = middle_of(problem, 1) - middle_of(problem, 0);
      const Vec3 turned = middle_of(repeated, 1) - middle_of(repeated, 0);
      const double turn = std::acos(across.normalized().dot(turned.normalized()));
      CHECK(turn <= 0.5 + 1e-6);
      CHECK(turn > 0);
    }
  }
}

TEST_SUITE("unit") {
  TEST_CASE("the same numbers give the same repeat, and lengths of 0 the task itself") {
    Rng a(3), b(3);
    CHECK(repeat(task(), {}, a)->goals == repeat(task(), {}, b)->goals);
    const auto same = repeat(task(), {0, 0}, a);
    CHECK(same->goals.front() == task().goals.front());
  }

  TEST_CASE("what cannot be repeated is refused by name") {
    Rng rng(1);
    CHECK_FALSE(repeat(task(), {-1, 0}, rng).has_value());
    CHECK_FALSE(repeat(task(), {0, 0, 0, -1}, rng).has_value());
    Problem problem = task();
    problem.goals.clear();
    CHECK(contains(repeat(problem, {}, rng).error().message, problem.name));
    problem = task();
    problem.goals = {{1, 2}};
    CHECK(contains(repeat(problem, {}, rng).error().message, "goal"));
    problem = task();
    problem.scene = make_circle_scene("filled", {{0.5, 0, 2}});
    CHECK(contains(repeat(problem, {}, rng).error().message, "in contact"));
  }
}

}  // namespace mneme::test
