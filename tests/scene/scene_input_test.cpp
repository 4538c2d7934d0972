// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/scene_input.h"
#include "scene/yaml.h"

#include <doctest/doctest.h>

namespace mneme::test {
namespace {

const std::string kSceneSource = "f";

Result<Scene> read(const std::string& yaml) {
  return internal::without_throwing([&] {
    const auto value = internal::parse_yaml(yaml, "f");
    return internal::read_scene(internal::Input(value, kSceneSource), "default");
  });
}

TEST_SUITE("unit") {
  TEST_CASE("circles come before obstacles, and names must differ between them") {
    const std::string sphere = "type: sphere, position: [0, 0, 0], radius: 1}\n";
    const auto scene = read("obstacles:\n  - {name: b, " + sphere + "circles: {a: [0, 0, 1]}\n");
    REQUIRE(scene.has_value());
    CHECK(scene->obstacles[0].name == "a");
    CHECK(scene->obstacles[1].name == "b");
    const auto clash = read("circles: {a: [0, 0, 1]}\nobstacles:\n  - {name: a, " + sphere);
    REQUIRE_FALSE(clash.has_value());
    CHECK(clash.error().message ==
          "f:3: key obstacles[0]: expected a name of its own, got \"a\" a second time");
  }

  TEST_CASE("a scene that gives no name has the default one") {
    CHECK(read("circles: []").value().name == "default");
    CHECK(read("name: x").value().name == "x");
  }

  TEST_CASE("anything but a map of the known keys is refused") {
    CHECK(read("circle: []").error().message ==
          "f:1: key circle: unknown key, expected one of name, circles, obstacles");
    CHECK(read("").error().message == "f:1: expected a map, got nothing");
    CHECK(read("just text").error().message == "f:1: expected a map, got \"just text\"");
    CHECK(read("circles: 3").error().message == "f:1: key circles: expected a list, got 3");
    CHECK(read("circles:\n  a: [0, 0]").error().message ==
          "f:2: key circles.a: expected 3 numbers (x, y, radius in metres), got a list of 2");
    CHECK(read("circles: [[0, 0, 0]]").error().message ==
          "f:1: key circles[0][2]: expected a number above 0, got 0");
  }
}

}  // namespace
}  // namespace mneme::test
