// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/planar_chain.h"
#include "support/planar_memory.h"
#include "support/threaded.h"

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("the first link across the gap is found, the others do not count") {
    const Robot arm = planar_arm({2, 2, 2});
    // The gap is the segment from (3, 0.5) to (3, -0.5).
    const PrimitiveKey key = {3, 1.5, 1, 3, -1.5, 1};
    const auto first = [&](const Configuration& q) { return first_crossing_link(arm, key, q); };
    CHECK(first({0, 0, 0}) == 1);
    CHECK(first({kPi / 2, 0, 0}) == -1);
    CHECK(first({kPi, 0, 0}) == -1);
    // There and back again: both the second and the third link cross.
    CHECK(first({0.05, 0, kPi - 0.1}) == 1);
    // Around a circle: no link between the surfaces.
    CHECK(first({1.2, -0.3, -0.9}) == -1);
    // Up, across and down through the gap with the last link.
    const double elbow = std::acos(std::hypot(2, 0.3) / 4);
    CHECK(first({std::atan2(0.3, 2) + elbow, -2 * elbow, elbow - std::atan2(0.3, 2)}) == 2);
    // The order of the circles and a mirror image change nothing.
    CHECK(first_crossing_link(arm, {3, -1.5, 1, 3, 1.5, 1}, Configuration{0, 0, 0}) == 1);
    // A stretched arm that points away from a gap on its line.
    CHECK(first_crossing_link(arm, {-9, 0, 1, -6, 0, 1}, Configuration{0, 0, 0}) == -1);
  }

  TEST_CASE("the base may stand in the gap: then the first link crosses it") {
    const Robot arm = planar_arm({2, 2});
    const PrimitiveKey key = {0, 1.5, 1, 0, -1.5, 1};
    CHECK(first_crossing_link(arm, key, Configuration{0.1, 0.2}) == 0);
    CHECK(first_crossing_link(arm, key, Configuration{kPi, 0.2}) == 0);
  }

  TEST_CASE("a gap out of reach of a link gives nothing, and so do no attempts") {
    const Robot arm = planar_arm({2, 2, 2});
    const PrimitiveKey key = {5, 1.5, 1, 5, -1.5, 1};
    const CollisionChecker checker = make_checker(arm, make_scene(key));
    Rng rng(2);
    CHECK(!sample_threaded(checker, key, 0, 500, rng).has_value());
    CHECK(!sample_threaded(checker, key, 1, 500, rng).has_value());
    CHECK(sample_threaded(checker, key, 2, 500, rng).has_value());
    CHECK(!sample_threaded(checker, key, 2, 0, rng).has_value());
  }
}

TEST_SUITE("law") {
  TEST_CASE("threaded configurations are free and cross with the link that was asked for") {
    const Robot robot = planar8();
    Rng rng(3);
    int found = 0, asked = 0;
    for (const PrimitiveKey& key : random_keys(150, 4)) {
      const CollisionChecker checker = make_checker(robot, make_scene(key));
      for (int link = 0; link < robot.joint_count(); ++link) {
        ++asked;
        const auto q = sample_threaded(checker, key, link, 100, rng);
        if (!q) continue;
        ++found;
        CHECK(!robot.describe_violation(*q, "threaded").has_value());
        CHECK(checker.is_valid(std::span<const double>(*q)));
        CHECK(checker.contacts(*q).empty());
        CHECK(first_crossing_link(robot, key, *q) == link);
      }
    }
    CHECK(found > asked / 3);
  }

  TEST_CASE(
      "threaded configurations keep the limits of narrow joints, and are found all the same") {
    for (const auto& [lower, upper] : {std::pair{-1.5, 1.5}, {-0.8, 2.0}, {0.2, 6.2}}) {
      const Robot robot = limited_arm(planar8_lengths(), lower, upper);
      Rng rng(1);
      int found = 0, asked = 0;
      for (const PrimitiveKey& key : random_keys(30, 1)) {
        const CollisionChecker checker = make_checker(robot, make_scene(key));
        for (int link = 0; link < robot.joint_count(); ++link) {
          ++asked;
          const auto q = sample_threaded(checker, key, link, 300, rng);
          if (!q) continue;
          ++found;
          CHECK(!robot.describe_violation(*q, "threaded").has_value());
          CHECK(checker.is_valid(std::span<const double>(*q)));
          CHECK(first_crossing_link(robot, key, *q) == link);
        }
      }
      CAPTURE(robot.group_joint(1).lower);
      CAPTURE(asked);
      CHECK(found > asked / 3);
    }
  }

  TEST_CASE("configurations outside are free and do not cross, and are as many as were asked for") {
    const Robot robot = planar8();
    Rng rng(6);
    for (const PrimitiveKey& key : random_keys(20, 5)) {
      const CollisionChecker checker = make_checker(robot, make_scene(key));
      const auto found = sample_outside(checker, key, 3, 1000, rng);
      CHECK(found.size() == 3);
      for (const Configuration& q : found) {
        CHECK(checker.is_valid(std::span<const double>(q)));
        CHECK(first_crossing_link(robot, key, q) < 0);
      }
      CHECK(sample_outside(checker, key, 3, 0, rng).empty());
    }
  }

  TEST_CASE("the same stream of numbers gives the same configuration, the next one another") {
    const Robot robot = planar8();
    const PrimitiveKey key = random_keys(1, 7)[0];
    const CollisionChecker checker = make_checker(robot, make_scene(key));
    Rng first(5), second(5);
    const auto q = sample_threaded(checker, key, 6, 1000, first);
    REQUIRE(q.has_value());
    CHECK(q == sample_threaded(checker, key, 6, 1000, second));
    CHECK(q != sample_threaded(checker, key, 6, 1000, second));
  }
}

}  // namespace mneme::test
