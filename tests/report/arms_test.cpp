// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/arms.h"

#include "report/report_support.h"

#include <map>

namespace mneme::internal {
namespace {

GaussianMixture mixture_of(const std::vector<Origin>& origins) {
  GaussianMixture mixture;
  mixture.joint_count = 1;
  mixture.means.assign(origins.size(), 0);
  mixture.origins = origins;
  return mixture;
}

TEST_SUITE("unit") {
  TEST_CASE("Links joined end to end are one line through the joints") {
    const Robot robot = test::unit_arm(3);
    const Arm arm = arm_at(robot, Configuration{0, 1.5707963267948966, 0});
    REQUIRE(arm.size() == 1);
    REQUIRE(arm[0].points.size() == 4);
    CHECK(arm[0].radius == doctest::Approx(0.001));
    const std::vector<Point> expected = {{0, 0}, {1, 0}, {1, 1}, {1, 2}};
    for (std::size_t i = 0; i < expected.size(); ++i) {
      CHECK(arm[0].points[i].x == doctest::Approx(expected[i].x));
      CHECK(arm[0].points[i].y == doctest::Approx(expected[i].y));
    }
  }

  TEST_CASE("Configurations are spread over the path by its length, ends included") {
    const Robot robot = test::unit_arm(2);
    const auto spread = spread_along(robot, {{0, 0}, {0.3, 0}, {0.3, 0.9}}, 5);
    REQUIRE(spread.size() == 5);
    const std::vector<Configuration> expected = {
        {0, 0}, {0.3, 0}, {0.3, 0.3}, {0.3, 0.6}, {0.3, 0.9}};
    for (std::size_t i = 0; i < 5; ++i) {
      CHECK(robot.distance(spread[i], expected[i]) == doctest::Approx(0).epsilon(1e-9));
    }
  }

  TEST_CASE("A continuous joint is spread over the shorter way round") {
    const Robot robot = test::unit_arm(1);
    const auto spread = spread_along(robot, {{3.0}, {-3.0}}, 3);
    CHECK(std::abs(spread[1][0]) == doctest::Approx(3.14159265).epsilon(1e-6));
  }

  TEST_CASE("A path of one state, or of equal ones, is that state") {
    const Robot robot = test::unit_arm(2);
    for (const Path& path : {Path{{1, 2}}, Path{{1, 2}, {1, 2}}}) {
      const auto spread = spread_along(robot, path, 3);
      REQUIRE(spread.size() == 3);
      CHECK(spread[2] == Configuration{1, 2});
    }
  }

  TEST_CASE("All components are shown if they are few, none if none are wanted") {
    CHECK(choose_components(mixture_of({0, 1, 0}), 60) == std::vector<int>{0, 1, 2});
    CHECK(choose_components(mixture_of({0, 1, 0}), 0).empty());
    CHECK(choose_components(mixture_of({0, 1, 0}), -1).empty());
    CHECK(choose_components(GaussianMixture{}, 60).empty());
  }

  TEST_CASE("Primitives with few components are seen beside those with many") {
    std::vector<Origin> origins(1000, 0);
    origins.insert(origins.end(), 5, 1);
    const GaussianMixture mixture = mixture_of(origins);
    std::map<Origin, int> shown;
    for (const int component : choose_components(mixture, 20)) {
      ++shown[mixture.origins[static_cast<std::size_t>(component)]];
    }
    CHECK(shown[0] == 15);
    CHECK(shown[1] == 5);
  }
}

TEST_SUITE("law") {
  TEST_CASE("Chosen components differ, are in order and fill the limit") {
    Rng rng(5);
    for (int round = 0; round < 200; ++round) {
      CAPTURE(round);
      std::vector<Origin> origins;
      for (std::uint32_t i = rng.index(100); i > 0; --i)
        origins.push_back(static_cast<int>(rng.index(6)));
      const int limit = static_cast<int>(rng.index(80));
      const std::vector<int> chosen = choose_components(mixture_of(origins), limit);
      CHECK(static_cast<int>(chosen.size()) == std::min(limit, static_cast<int>(origins.size())));
      for (std::size_t i = 1; i < chosen.size(); ++i) CHECK(chosen[i - 1] < chosen[i]);
      if (!chosen.empty()) CHECK(chosen.back() < static_cast<int>(origins.size()));
    }
  }
}

}  // namespace
}  // namespace mneme::internal
