// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/moveit_request.h"
#include "scene/read_yaml.h"

#include <doctest/doctest.h>

namespace mneme::test {
namespace {

using internal::read_moveit_request;

std::string request_failure(const std::string& yaml) { return failure_of(yaml, read_moveit_request); }

const std::string kGoal =
    "goal_constraints: [{joint_constraints: [{joint_name: a, position: 1}]}]\n";

TEST_SUITE("unit") {
  TEST_CASE("a goal is the centre of what its tolerances allow") {
    const auto request = read_yaml(
        "group_name: arm\nplanner_id: RRT\nworkspace_parameters: {min_corner: [0, 0, 0]}\n"
        "goal_constraints:\n"
        "  - joint_constraints: [{joint_name: a, position: 1, tolerance_above: 0.4, "
        "tolerance_below: 0.2, weight: 1}]\n"
        "    position_constraints: []\n"
        "  - joint_constraints: [{joint_name: a, position: 2}]\n"
        "path_constraints: {joint_constraints: []}\ntrajectory_constraints:\n",
        [](const internal::Input& input) {
          auto read = read_moveit_request(input);
          read.goal_places.clear();
          return read;
        });
    REQUIRE_MESSAGE(request.has_value(), (request ? "" : request.error().message));
    CHECK(request->group == "arm");
    REQUIRE(request->goals.size() == 2);
    CHECK(request->goals[0].at("a") == doctest::Approx(1.1));
    CHECK(request->goals[1].at("a") == 2);
  }

  TEST_CASE("goals and paths that are constrained otherwise are refused by name") {
    CHECK(request_failure("goal_constraints:\n  - position_constraints: [{link_name: hand}]") ==
          "f:2: key goal_constraints[0].position_constraints: position_constraints are not "
          "supported; expected a goal of joint_constraints alone");
    CHECK(request_failure("goal_constraints:\n  - orientation_constraints: [{link_name: hand}]") ==
          "f:2: key goal_constraints[0].orientation_constraints: orientation_constraints are not "
          "supported; expected a goal of joint_constraints alone");
    CHECK(request_failure(kGoal + "path_constraints: {orientation_constraints: [{link_name: hand}]}") ==
          "f:2: key path_constraints.orientation_constraints: orientation_constraints are not "
          "supported; expected a path without constraints");
    CHECK(request_failure(kGoal + "path_constraints: {joint_constraints: [{joint_name: a}]}") ==
          "f:2: key path_constraints: joint_constraints are not supported here; expected a path "
          "without constraints");
    CHECK(
        request_failure(kGoal + "trajectory_constraints: {constraints: [{}]}") ==
        "f:2: key trajectory_constraints: trajectory_constraints are not supported; expected none");
  }

  TEST_CASE("requests that are malformed are refused with line and key") {
    CHECK(request_failure("group_name: arm") == "f:1: expected the key goal_constraints, which is missing");
    CHECK(request_failure("goal_constraints: []") ==
          "f:1: key goal_constraints: expected at least one goal, got a list of 0");
    CHECK(request_failure("goal_constraints: [{name: g}]") ==
          "f:1: key goal_constraints[0]: expected joint_constraints, got none");
    CHECK(request_failure("goal_constraints: [{joint_constraints: [{joint_name: a}]}]") ==
          "f:1: key goal_constraints[0].joint_constraints[0]: expected the key position, which is "
          "missing");
    CHECK(request_failure("goal_constraints: [{joint_constraints: [{joint_name: a, position: 1, "
                  "tolerance_below: -1}]}]") ==
          "f:1: key goal_constraints[0].joint_constraints[0].tolerance_below: expected a tolerance "
          "of 0 or more, got -1");
    CHECK(request_failure("goal_constraints: [{joint_constraints: [{joint_name: a, position: 1}, "
                  "{joint_name: a, position: 1}]}]") ==
          "f:1: key goal_constraints[0].joint_constraints[1].joint_name: expected each joint once, "
          "got a again");
    CHECK(request_failure(kGoal + "goal: 1").find("f:2: key goal: unknown key, expected one of ") == 0);
  }
}

}  // namespace
}  // namespace mneme::test
