// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/warp_paths.h"

#include "support/planar_memory.h"

namespace mneme::test {
namespace {

Experience remember(const Robot& robot, const Path& path) {
  return learn_whole_paths(robot, std::vector<Path>{path}).front();
}

GaussianMixture warp(const Robot& robot, const Configuration& start, const Configuration& goal,
                     const std::vector<const Experience*>& rows) {
  std::vector<PrimitiveRetrieval> retrievals(1);
  for (const Experience* row : rows) {
    retrievals[0].matches.push_back({std::make_shared<const Experience>(*row), 0, {}});
  }
  return internal::warp_paths(robot, start, std::vector<Configuration>{goal}, retrievals);
}

void check_row(const GaussianMixture& mixture, int row, const Configuration& expected) {
  for (std::size_t j = 0; j < expected.size(); ++j) {
    const std::size_t at = static_cast<std::size_t>(row) * expected.size() + j;
    CHECK(mixture.means.at(at) == doctest::Approx(expected[j]).epsilon(1e-5));
  }
}

}  // namespace

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

  TEST_CASE("components stand in the order of the matches and count for their goal") {
    const Robot robot = planar_arm({1, 1});
    const Experience a = remember(robot, {{0, 0}, {0, 1}, {0, 2}});
    const Experience b = remember(robot, {{0, 0}, {1, 1}, {0, 2}});
    std::vector<PrimitiveRetrieval> retrievals(2);
    retrievals[0].matches = {{std::make_shared<const Experience>(b), 0, {}},
                             {std::make_shared<const Experience>(a), 1, {}}};
    retrievals[1].matches = {{std::make_shared<const Experience>(a), 0, {}}};
    const std::vector<Configuration> goals = {{0, 2}, {0, 4}};
    const GaussianMixture mixture = internal::warp_paths(robot, {0, 0}, goals, retrievals);
    CHECK(mixture.origins == std::vector<Origin>{0, 0, 0, 0, 1, 1});
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

}  // namespace mneme::test
