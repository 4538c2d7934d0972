// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/scene_input.h"

#include <doctest/doctest.h>

namespace mneme::test {
namespace {

using internal::SceneBuilder;

TEST_SUITE("unit") {
  TEST_CASE("shapes of one body make one obstacle at the place of the first") {
    SceneBuilder builder;
    CHECK_FALSE(builder.add("leg", "table", Sphere{}));
    CHECK_FALSE(builder.add("ball", "", Sphere{}));
    CHECK_FALSE(builder.add("", "table", Box{}));
    const Scene scene = builder.take("room");
    CHECK(scene.name == "room");
    REQUIRE(scene.obstacles.size() == 2);
    CHECK(scene.obstacles[0].name == "table");
    REQUIRE(scene.obstacles[0].shapes.size() == 2);
    CHECK(shape_name(scene.obstacles[0].shapes[1]) == "box");
    CHECK(scene.obstacles[1].name == "ball");
  }

  TEST_CASE("names that are missing or taken are refused") {
    SceneBuilder builder;
    REQUIRE_FALSE(builder.add("a", "", Sphere{}));
    REQUIRE_FALSE(builder.add("part", "body", Sphere{}));
    CHECK(builder.add("", "", Sphere{}) == "expected a name");
    CHECK(builder.add("a", "", Sphere{}) == "expected a name of its own, got \"a\" a second time");
    const std::string bad = "expected a name that is UTF-8 text without NUL, got \"b?\"";
    CHECK(builder.add("b\xff", "", Sphere{}) == bad);
    CHECK(builder.add("", "b\xfe", Sphere{}) == bad);
    CHECK(builder.add("part", "body", Sphere{}) ==
          "expected a name of its own, got \"part\" a second time");
    CHECK(builder.add("body", "", Sphere{}) ==
          "expected a name of its own, got \"body\", which names a body");
    CHECK(builder.add("b", "a", Sphere{}) ==
          "expected a body name of its own, got \"a\", which names an obstacle");
    CHECK(builder.take("").obstacles.size() == 2);
  }
}

}  // namespace
}  // namespace mneme::test
