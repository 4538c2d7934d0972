// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/small_worlds.h"
#include "path/sweep.h"

namespace mneme::test {
namespace {

using internal::Sweep;

/// True if the exact contacts at `states` states of the motion are none.
bool is_free_at(const CollisionChecker& checker, const Configuration& from, const Configuration& to,
                int states) {
  const Configuration delta = checker.robot().difference(from, to);
  for (int i = 0; i <= states; ++i) {
    Configuration q = from;
    for (std::size_t j = 0; j < q.size(); ++j) q[j] += delta[j] * i / states;
    if (!checker.contacts(q).empty()) return false;
  }
  return true;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a link that dips into another one between two free states is found") {
    const Robot robot = thick_arm({1, 0.5, 0.35});
    const CollisionChecker checker = make_checker(robot, {});
    const Configuration left = {0, 2.4, 1.5}, right = {0, 2.4, 3.0}, up = {1, 2.4, 0.2};
    for (const Configuration& q : {left, right, up}) REQUIRE(checker.contacts(q).empty());
    const Sweep sweep(robot, {});
    CHECK(sweep.is_free(left, up));
    CHECK_FALSE(sweep.is_free(left, right));
    CHECK_FALSE(sweep.is_free(right, left));
    CHECK_FALSE(sweep.is_free(up, right));
  }

  TEST_CASE("an obstacle thinner than the step between two states is found") {
    const Robot robot = thick_arm({1, 1});
    const Scene thin = make_circle_scene("", {{1.5, 0, 1e-4}});
    CHECK_FALSE(Sweep(robot, thin).is_free(Configuration{-1, 0}, Configuration{1.1, 0}));
    CHECK(Sweep(robot, thin).is_free(Configuration{0.1, 0}, Configuration{1.1, 0}));
    // A continuous joint takes the shorter way, past pi.
    CHECK(Sweep(robot, thin).is_free(Configuration{-2, 0}, Configuration{2, 0}));
  }

  TEST_CASE("contact by less than the tolerance is none, and a little more is") {
    const Robot robot = thick_arm({1, 1});
    const auto is_free = [&](double overlap) {
      const Scene scene = make_circle_scene("", {{2 + 0.01 + 0.5 - overlap, 0, 0.5}});
      return Sweep(robot, scene).is_free(Configuration{-0.3, 0}, Configuration{0.3, 0});
    };
    CHECK(is_free(-1e-4));
    CHECK(is_free(0.2 * Sweep::kTolerance));
    CHECK_FALSE(is_free(1.5 * Sweep::kTolerance));
    // An end counts like all else.
    const auto ends_free = [&](double overlap) {
      const Scene scene{"", {make_ball("ball", {1, 0, 0}, 0.2)}};
      const Configuration end = {1 - 0.3 + overlap, 0, 0};
      return Sweep(gantry(), scene).is_free(Configuration{-1.234, 0, 0}, end);
    };
    CHECK(ends_free(0.2 * Sweep::kTolerance));
    for (double more = 1.01; more < 4; more += 0.1) {
      CHECK_FALSE(ends_free(more * Sweep::kTolerance));
    }
  }

  TEST_CASE("closer to an obstacle than the margin is contact, to another link it is not") {
    const Robot robot = thick_arm({1, 1});
    const auto is_free = [&](double gap, double margin) {
      const Scene scene = make_circle_scene("", {{2 + 0.01 + 0.5 + gap, 0, 0.5}});
      return Sweep(robot, scene, margin).is_free(Configuration{-0.3, 0}, Configuration{0.3, 0});
    };
    CHECK(is_free(0.01, 0.009));
    CHECK_FALSE(is_free(0.01, 0.011));
    const Robot folded = thick_arm({1, 0.5, 0.35});
    CHECK(Sweep(folded, {}, 0.5).is_free(Configuration{0, 2.4, 1.5}, Configuration{1, 2.4, 0.2}));
  }

  TEST_CASE("a sweep that must stop finds nothing free") {
    const Robot robot = thick_arm({1, 1});
    const Scene scene = make_circle_scene("", {{2.02, 0, 0.0099}});
    const Configuration from = {-0.3, 0}, to = {0.3, 0};
    int asked = 0;
    REQUIRE(Sweep(robot, scene).is_free(from, to, [&] { return ++asked < 0; }));
    REQUIRE(asked > 3);
    int left = 3;
    CHECK_FALSE(Sweep(robot, scene).is_free(from, to, [&] { return left-- == 0; }));
    CHECK(left == -1);
  }

  TEST_CASE("sliding joints count by how far they slide") {
    const World world{"post", gantry(), {"", {make_ball("post", {0.01, 0, 0}, 0.001)}}, {}};
    const Sweep sweep(world.robot, world.scene);
    CHECK_FALSE(sweep.is_free(Configuration{-2, 0, 0}, Configuration{2, 0, 0}));
    CHECK(sweep.is_free(Configuration{-2, 0, 0.5}, Configuration{2, 0, 0.5}));
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
    int free = 0, blocked = 0, refused = 0;
    for (int i = 0; i < 150; ++i) {
      CAPTURE(i);
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
      const bool is_dense_free = is_free_at(checker, from, to, kStates);
      const bool is_sweep_free = Sweep(robot, scene).is_free(from, to);
      ++(is_sweep_free ? free : blocked);
      if (is_sweep_free) CHECK_MESSAGE(is_dense_free, "seed " << kSeed);
      refused += is_dense_free && !is_sweep_free ? 1 : 0;
    }
    CHECK_MESSAGE(refused <= 1, "seed " << kSeed);
    CHECK(free > 5);
    CHECK(blocked > 5);
  }
}

}  // namespace mneme::test
