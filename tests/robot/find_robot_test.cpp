// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/small_robots.h"
#include "support/environment.h"
#include "support/support.h"

#include <string>

namespace mneme {
namespace {

/// Sets MNEME_ROBOT_PATH for one scope.
struct RobotPath : test::EnvironmentVariable {
  explicit RobotPath(const std::string& value) : EnvironmentVariable("MNEME_ROBOT_PATH", value) {}
};

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("robots that came with mneme are found by name, with or without extension") {
    const RobotPath nothing("");
    for (const char* name : {"planar8", "planar8.urdf"}) {
      const auto path = find_robot(name);
      REQUIRE(path.has_value());
      CHECK(load_robot(*path).has_value());
    }
  }

  TEST_CASE("the directories of MNEME_ROBOT_PATH come first, in their order") {
    const test::TemporaryDirectory first, second;
    test::write_file(second / "planar8.urdf", "");
    const RobotPath path(first / "" + "::" + second / "");
    CHECK(std::filesystem::equivalent(find_robot("planar8").value(), second / "planar8.urdf"));
    test::write_file(first / "planar8.urdf", "");
    CHECK(std::filesystem::equivalent(find_robot("planar8").value(), first / "planar8.urdf"));
  }

  TEST_CASE("an unknown robot is an error that names the directories and what is there") {
    const RobotPath path("/nowhere");
    const auto found = find_robot("no_such_robot");
    REQUIRE_FALSE(found.has_value());
    CHECK(found.error().code == ErrorCode::io);
    CHECK(test::contains(found.error().message, "'no_such_robot'"));
    CHECK(test::contains(found.error().message, "/nowhere, "));
    CHECK(test::contains(found.error().message, "robots (which has fetch, panda, planar8, ur5)"));
  }

  TEST_CASE("a path is no name") {
    CHECK(find_robot("../robots/planar8").error().code == ErrorCode::invalid);
    CHECK(find_robot("").error().code == ErrorCode::invalid);
  }
}

}  // namespace mneme
