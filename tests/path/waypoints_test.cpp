// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "path/waypoints.h"
#include "planning/small_worlds.h"

#include <vector>

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("points of a path are found by arc length") {
    internal::Waypoints waypoints(gantry());
    waypoints.assign({0, 0, 0, 1, 0, 0, 1, 2, 0});
    CHECK(waypoints.count() == 3);
    CHECK(waypoints.length() == 3);
    CHECK(waypoints.locate(0.5f).motion == 0);
    CHECK(waypoints.locate(2.0f).motion == 1);
    CHECK(waypoints.locate(2.0f).fraction == 0.5f);
    CHECK(waypoints.locate(-1).fraction == 0);
    CHECK(waypoints.locate(4).motion == 1);
    CHECK(waypoints.locate(4).fraction == 1);
    CHECK(waypoints.arc_length(1) == 1);
    std::vector<float> q(3);
    waypoints.write({1, 0.25f}, q.data());
    CHECK(q == std::vector<float>{1, 0.5f, 0});
  }

  TEST_CASE("waypoints are replaced by fewer or more") {
    internal::Waypoints waypoints(gantry());
    waypoints.assign({0, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0});
    const std::vector<float> rows = {1, 1, 0, 1.5f, 1, 0, 2, 1, 0};
    waypoints.replace(0, 3, rows);
    REQUIRE(waypoints.count() == 5);
    CHECK(waypoints[2][0] == 1.5f);
    CHECK(waypoints[4][0] == 3);
    waypoints.replace(0, 4, {});
    CHECK(waypoints.count() == 2);
    CHECK(waypoints.length() == 3);
  }

  TEST_CASE("continuous joints are unwrapped, and half a turn has two ways") {
    internal::Waypoints waypoints(thick_arm({1, 1}));
    waypoints.assign({3, 0, -3, 0, 3, 0});
    CHECK(waypoints[1][0] == doctest::Approx(2 * kPi - 3));
    CHECK(waypoints[2][0] == doctest::Approx(3));
    CHECK(waypoints.has_unique_direction(waypoints[0], waypoints[1]));
    const std::vector<float> a = {0, 0}, b = {static_cast<float>(kPi), 0};
    CHECK(!waypoints.has_unique_direction(a.data(), b.data()));
  }
}

}  // namespace mneme::test
