// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/problem.h"

#include "problem/small_robots.h"
#include "support/support.h"

#include <limits>

namespace mneme::test {
namespace {

Problem read_back(const Problem& problem, const std::string& robot) {
  const TemporaryDirectory directory;
  write_file(directory / "p.yaml", to_yaml(problem, robot));
  const auto read = load_problem(directory / "p.yaml");
  REQUIRE_MESSAGE(read.has_value(), (read ? "" : read.error().message));
  return *read;
}

TEST_SUITE("unit") {
  TEST_CASE("a problem is written with its scene inside") {
    const Problem problem{"p",   planar8(), "", make_circle_scene("s", {{1, 2, 0.5}}),
                          {0.1}, {{0.2}},   {}};
    CHECK(to_yaml(problem, "planar8") ==
          "name: p\n"
          "robot: planar8\n"
          "joints: [joint_1, joint_2, joint_3, joint_4, joint_5, joint_6, joint_7, joint_8]\n"
          "scene:\n"
          "  name: s\n"
          "  obstacles:\n"
          "    - {name: circle_1, type: sphere, position: [1, 2, 0], radius: 0.5}\n"
          "start: [0.1]\n"
          "goal: [0.2]\n");
  }

  TEST_CASE("several goals, an empty scene and NaN read back") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const Problem problem{"a: b", planar8(), "", {"", {}}, {nan, 1.0 / 3}, {{1}, {2}}, {}};
    const Problem read = read_back(problem, "planar8");
    CHECK(read.name == "a: b");
    CHECK(std::isnan(read.start.at(0)));
    CHECK(read.start.at(1) == 1.0 / 3);
    CHECK(read.goals == problem.goals);
    CHECK(read.scene.obstacles.empty());
  }

  TEST_CASE("the group and the fixed joints read back") {
    const TemporaryDirectory directory;
    write_file(directory / "lifter.urdf", kLiftUrdf);
    RobotOptions options;
    options.joints = {"turn", "lift"};
    options.fixed_values = {{"grip", 0.03}};
    const auto robot = load_robot(directory / "lifter.urdf", options);
    REQUIRE_MESSAGE(robot.has_value(), (robot ? "" : robot.error().message));
    const Problem problem{"p", *robot, "", {"s", {}}, {0, 0}, {{1, 1}}, {}};
    CHECK(read_back(problem, directory / "lifter.urdf").robot.hash() == robot->hash());
  }

  TEST_CASE("a group reads back whatever groups the robot's SRDF has") {
    const TemporaryDirectory directory;
    write_file(directory / "lifter.urdf", kLiftUrdf);
    RobotOptions options;
    options.joints = {"lift", "turn", "grip"};
    const auto robot = load_robot(directory / "lifter.urdf", options);
    REQUIRE_MESSAGE(robot.has_value(), (robot ? "" : robot.error().message));
    write_file(directory / "lifter.srdf", R"(<robot name="lifter">
      <group name="arm"><joint name="turn"/></group></robot>)");
    const Problem problem{"p", *robot, "", {"s", {}}, {0, 0, 0}, {{1, 1, 0}}, {}};
    CHECK(read_back(problem, directory / "lifter.urdf").robot.joint_count() == 3);
  }
}

}  // namespace
}  // namespace mneme::test
