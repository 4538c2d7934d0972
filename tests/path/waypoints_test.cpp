// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "path/waypoints.h"
#include "planning/small_worlds.h"

#include <vector>

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("points of a path are found by their way from the start") {
    internal::Waypoints way(gantry());
    way.assign({0, 0, 0, 1, 0, 0, 1, 2, 0});
    CHECK(way.count() == 3);
    CHECK(way.length() == 3);
    CHECK(way.locate(0.5f).motion == 0);
    CHECK(way.locate(2.0f).motion == 1);
    CHECK(way.locate(2.0f).fraction == 0.5f);
    CHECK(way.locate(-1).fraction == 0);
    CHECK(way.locate(4).motion == 1);
    CHECK(way.locate(4).fraction == 1);
    CHECK(way.way_to(1) == 1);
    std::vector<float> q(3);
    way.write({1, 0.25f}, q.data());
    CHECK(q == std::vector<float>{1, 0.5f, 0});
  }

  TEST_CASE("waypoints are replaced by fewer or more") {
    internal::Waypoints way(gantry());
    way.assign({0, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0});
    const std::vector<float> rows = {1, 1, 0, 1.5f, 1, 0, 2, 1, 0};
    way.replace(0, 3, rows);
    REQUIRE(way.count() == 5);
    CHECK(way[2][0] == 1.5f);
    CHECK(way[4][0] == 3);
    way.replace(0, 4, {});
    CHECK(way.count() == 2);
    CHECK(way.length() == 3);
  }

  TEST_CASE("continuous joints are unwrapped, and half a turn has two ways") {
    internal::Waypoints way(thick_arm({1, 1}));
    way.assign({3, 0, -3, 0, 3, 0});
    CHECK(way[1][0] == doctest::Approx(2 * kPi - 3));
    CHECK(way[2][0] == doctest::Approx(3));
    CHECK(way.has_one_way(way[0], way[1]));
    const std::vector<float> a = {0, 0}, b = {static_cast<float>(kPi), 0};
    CHECK(!way.has_one_way(a.data(), b.data()));
  }
}

}  // namespace mneme::test
