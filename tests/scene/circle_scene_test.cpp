// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/scene.h"

#include <doctest/doctest.h>

namespace mneme::test {
namespace {

TEST_SUITE("unit") {
  TEST_CASE("circles become numbered spheres in the plane z = 0") {
    const Scene scene = make_circle_scene("two", {{1, 2, 3}, {4, 5, 6}});
    CHECK(scene.name == "two");
    REQUIRE(scene.obstacles.size() == 2);
    CHECK(scene.obstacles[1].name == "circle_2");
    REQUIRE(scene.obstacles[1].shapes.size() == 1);
    const auto sphere = std::get<Sphere>(scene.obstacles[1].shapes[0]);
    CHECK(sphere.center == Vec3(4, 5, 0));
    CHECK(sphere.radius == 6);
  }
}

}  // namespace
}  // namespace mneme::test
