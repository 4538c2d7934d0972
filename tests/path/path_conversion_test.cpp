// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/small_worlds.h"
#include "path/waypoints.h"

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("values are rounded to the nearest float and widened without change") {
    const std::vector<float> floats = internal::to_floats(Configuration{0.1, -1.5, 0});
    CHECK(floats == std::vector<float>{0.1f, -1.5f, 0.0f});
    CHECK(internal::to_floats({}).empty());
    const Path path = internal::to_path(gantry(), {floats, {1, 2, -2}});
    REQUIRE(path.size() == 2);
    CHECK(path[0] == Configuration{static_cast<double>(0.1f), -1.5, 0});
    CHECK(path[1] == Configuration{1, 2, -2});
    CHECK(internal::to_path(gantry(), {}).empty());
  }

  TEST_CASE("an unwrapped path begins at the turn of the start and is continuous") {
    const Robot arm = thick_arm({1, 1});  // the first joint is continuous
    const Path path = unwrapped(arm, {{3, 0}, {-3, 1}, {2.9, 0.5}, {0.1, 2}}, {3 + 4 * kPi, 0});
    REQUIRE(path.size() == 4);
    CHECK(path.front() == Configuration{3 + 4 * kPi, 0});
    CHECK(path[1][0] == doctest::Approx(6 * kPi - 3));
    CHECK(path[2][0] == doctest::Approx(4 * kPi + 2.9));
    CHECK(path[3][0] == doctest::Approx(4 * kPi + 0.1));
    CHECK(path[3][1] == 2);
    CHECK(unwrapped(arm, {}, {0, 0}).empty());
    const Path limited = {{1, 2, -2}, {-1, 0, 2}};
    CHECK(unwrapped(gantry(), limited, {1, 2, -2}) == limited);
  }

  TEST_CASE("what single precision cannot say is brought within the limits") {
    Robot::Parts parts;
    parts.name = "locked";
    parts.links.push_back({.name = "base"});
    add_link(parts, JointType::continuous, Vec3::Zero(), Vec3::UnitZ(), kPi, {});
    add_link(parts, JointType::revolute, Vec3::Zero(), Vec3::UnitZ(), 0, {});
    parts.joints[1].lower = parts.joints[1].upper = 0.1;
    const auto half_turn = static_cast<float>(kPi);
    REQUIRE(static_cast<double>(half_turn) > kPi);
    const Path path = internal::to_path(make_small_robot(parts), {{half_turn, 0.1f}});
    REQUIRE(path.size() == 1);
    CHECK(path[0][0] >= -kPi);
    CHECK(path[0][0] == doctest::Approx(-kPi));
    CHECK(path[0][1] == 0.1);
  }
}

}  // namespace mneme::test
