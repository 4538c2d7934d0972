// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/report.h"

#include "report/report_support.h"

#include <limits>

namespace mneme {
namespace {

CollisionChecker checker_for(const std::vector<std::array<double, 3>>& circles, int joints = 3) {
  auto checker =
      CollisionChecker::make(test::unit_arm(joints), make_circle_scene("scene", circles));
  REQUIRE_MESSAGE(checker.has_value(), (checker ? "" : checker.error().message));
  return *checker;
}

TEST_SUITE("unit") {
  TEST_CASE("A path past an obstacle is free, one through it is not") {
    const CollisionChecker checker = checker_for({{0, 2, 0.2}});
    CHECK(is_path_free(checker.robot(), checker.scene(), {{0, 0, 0}, {1, 0.2, 0}}, 0.01));
    CHECK_FALSE(is_path_free(checker.robot(), checker.scene(), {{0.5, 0, 0}, {2.5, 0, 0}}, 0.01));
  }

  TEST_CASE("Both ends count") {
    const CollisionChecker checker = checker_for({{2, 0, 0.2}});
    CHECK_FALSE(is_path_free(checker.robot(), checker.scene(), {{0, 0, 0}, {1, 0, 0}}, 0.01));
    CHECK_FALSE(is_path_free(checker.robot(), checker.scene(), {{1, 0, 0}, {0, 0, 0}}, 0.01));
    CHECK_FALSE(is_path_free(checker.robot(), checker.scene(), {{0, 0, 0}}, 0.01));
    CHECK(is_path_free(checker.robot(), checker.scene(), {{1, 0, 0}}, 0.01));
  }

  TEST_CASE("What a coarse resolution jumps over, a fine one finds") {
    const CollisionChecker checker = checker_for({{3 * std::cos(0.31), 3 * std::sin(0.31), 0.01}});
    const Path path = {{0, 0, 0}, {1, 0, 0}};
    CHECK(is_path_free(checker.robot(), checker.scene(), path, 0.25));
    CHECK_FALSE(is_path_free(checker.robot(), checker.scene(), path, 0.002));
  }

  TEST_CASE("A continuous joint takes the shorter way round") {
    const std::vector<std::array<double, 3>> ahead = {{2, 0, 0.2}};
    const std::vector<std::array<double, 3>> behind = {{-2, 0, 0.2}};
    const Path path = {{2.5, 0, 0}, {-2.5, 0, 0}};
    CHECK(is_path_free(checker_for(ahead).robot(), checker_for(ahead).scene(), path, 0.01));
    CHECK_FALSE(is_path_free(checker_for(behind).robot(), checker_for(behind).scene(), path, 0.01));
  }

  TEST_CASE("An empty path, a state outside the limits and a senseless resolution are not free") {
    const CollisionChecker checker = checker_for({});
    CHECK_FALSE(is_path_free(checker.robot(), checker.scene(), {}, 0.01));
    CHECK_FALSE(is_path_free(checker.robot(), checker.scene(), {{0, 0, 0}, {0, 4, 0}}, 0.01));
    CHECK_FALSE(is_path_free(checker.robot(), checker.scene(),
                             {{0, 0, std::numeric_limits<double>::quiet_NaN()}}, 0.01));
    CHECK_FALSE(is_path_free(checker.robot(), checker.scene(), {{0, 0}}, 0.01));
    CHECK_FALSE(is_path_free(checker.robot(), checker.scene(), {{0, 0, 0}}, 0));
    CHECK(is_path_free(checker.robot(), checker.scene(), {{0, 0, 0}, {0, 0, 0}}, 0.01));
  }
}

TEST_SUITE("law") {
  TEST_CASE("The direction of a path does not matter") {
    const CollisionChecker checker = checker_for({{1.5, 1, 0.3}, {-1, 1.5, 0.4}});
    Rng rng(13);
    int free_count = 0;
    for (int round = 0; round < 100; ++round) {
      CAPTURE(round);
      const Path there = {test::random_configuration(checker.robot(), rng),
                          test::random_configuration(checker.robot(), rng)};
      const Path back(there.rbegin(), there.rend());
      const bool is_free = is_path_free(checker.robot(), checker.scene(), there, 0.005);
      CHECK(is_free == is_path_free(checker.robot(), checker.scene(), back, 0.005));
      free_count += is_free ? 1 : 0;
    }
    CHECK(free_count > 0);
    CHECK(free_count < 100);
  }
}

}  // namespace
}  // namespace mneme
