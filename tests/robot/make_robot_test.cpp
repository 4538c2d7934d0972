// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/small_robots.h"
#include "support/support.h"

#include <cmath>
#include <string>
#include <vector>

namespace mneme {
namespace {

using test::contains;
using test::kPi;
using test::make_chain;
using test::plan_for;

std::string refusal(Robot::Parts parts, const RobotOptions& options) {
  const auto robot = make_robot(std::move(parts), options);
  REQUIRE_FALSE(robot.has_value());
  CHECK(robot.error().code == ErrorCode::invalid);
  CHECK(contains(robot.error().message, "robot 'chain': "));
  return robot.error().message;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("without names the group is all movable joints in tree order") {
    Robot::Parts parts = make_chain(4);
    parts.joints[1].type = JointType::fixed;
    std::swap(parts.joints[0], parts.joints[3]);
    const Robot robot = test::require_robot(parts);
    CHECK(std::vector<int>(robot.group().begin(), robot.group().end()) == std::vector{0, 2, 3});
    CHECK(robot.joint_count() == 3);
    CHECK(robot.group_joint(1).name == "j3");
  }

  TEST_CASE("named joints become the group in the order of their names") {
    const Robot robot = test::require_robot(make_chain(3), plan_for({"j3", "j1"}));
    REQUIRE(robot.joint_count() == 2);
    CHECK(robot.group_joint(0).name == "j3");
    CHECK(robot.group_joint(1).name == "j1");
  }

  TEST_CASE("joints outside the group stand at zero or at the limit next to it") {
    Robot::Parts parts = make_chain(4);
    parts.joints[0].lower = 0.5;
    parts.joints[3].type = JointType::continuous;
    const Robot robot =
        test::require_robot(parts, plan_for({"j3"}, {{"j2", 9.0}, {"j4", 2 * kPi + 0.5}}));
    CHECK(robot.joints()[0].fixed_value == 0.5);
    CHECK(robot.joints()[1].fixed_value == 2);
    CHECK(robot.joints()[3].fixed_value == doctest::Approx(0.5));
    REQUIRE(robot.warnings().size() == 1);
    CHECK(contains(robot.warnings()[0], "value 9 of joint 'j2' is outside its limits [-2, 2]"));
  }

  TEST_CASE("options that do not fit the robot are refused by name") {
    CHECK(contains(refusal(make_chain(2), plan_for({"elbow"})),
                   "'elbow'; the movable joints are: j1, j2"));
    CHECK(contains(refusal(make_chain(2), plan_for({"j1", "j1"})), "'j1' stands twice"));
    CHECK(contains(refusal(make_chain(2), plan_for({"j1"}, {{"j9", 0}})), "'j9'"));
    CHECK(
        contains(refusal(make_chain(2), plan_for({"j1"}, {{"j1", 0}})), "'j1' has a fixed value"));
    CHECK(
        contains(refusal(make_chain(2), plan_for({"j1"}, {{"j2", std::nan("")}})), "'j2' is nan"));
    Robot::Parts parts = make_chain(2);
    parts.joints[1].type = JointType::fixed;
    CHECK(contains(refusal(parts, plan_for({"j2"})), "'j2' is fixed"));
  }

  TEST_CASE("pairs that the options allow to touch are not checked") {
    RobotOptions options;
    options.allowed_pairs.emplace_back("l3", "l1");
    const Robot robot = test::require_robot(make_chain(3), options);
    CHECK(std::vector(robot.self_pairs().begin(), robot.self_pairs().end()) ==
          std::vector<std::pair<int, int>>{{0, 2}, {0, 3}});
    options.allowed_pairs.emplace_back("l3", "hand");
    CHECK(contains(refusal(make_chain(3), options), "there is no link 'hand'"));
  }

  TEST_CASE("links that still have solids are refused by name") {
    Robot::Parts parts = make_chain(2);
    parts.links[1].solids.push_back(Box{});
    const auto robot = make_robot(parts);
    REQUIRE_FALSE(robot.has_value());
    CHECK(robot.error().code == ErrorCode::unsupported);
    CHECK(contains(robot.error().message, "robot 'chain': link 'l1' has collision geometry"));
    CHECK(contains(robot.error().message, "`mneme robot spheres`"));
  }

  TEST_CASE("a robot that cannot move or is no tree is refused") {
    for (const RobotOptions& options : {RobotOptions(), plan_for({"elbow"})}) {
      CHECK(contains(refusal(make_chain(1, JointType::fixed), options), "no joint that can move"));
    }
    Robot::Parts parts = make_chain(2);
    parts.joints.pop_back();
    CHECK(contains(refusal(parts, {}), "several root links"));
  }
}

}  // namespace mneme
