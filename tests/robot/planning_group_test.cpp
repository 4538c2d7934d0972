// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/planning_group.h"
#include "robot/small_robots.h"
#include "support/support.h"

#include <string>
#include <vector>

namespace mneme {
namespace {

using test::contains;
using Names = std::vector<std::string>;

/// Two arms, j1 - j2 and j3 - j4, on one base.
Robot::Parts two_arms(std::vector<JointGroup> groups = {}) {
  Robot::Parts parts = test::make_chain(4);
  parts.joints[2].parent_link = 0;
  parts.groups = std::move(groups);
  return parts;
}

RobotOptions group_named(const std::string& name) {
  RobotOptions options;
  options.group = name;
  return options;
}

Names chosen(const Robot::Parts& parts, const RobotOptions& options = {}) {
  const Robot robot = test::require_robot(parts, options);
  Names names;
  for (int i = 0; i < robot.joint_count(); ++i) names.push_back(robot.group_joint(i).name);
  return names;
}

std::string refusal(const Robot::Parts& parts, const RobotOptions& options = {}) {
  const auto robot = make_robot(parts, options);
  REQUIRE_FALSE(robot.has_value());
  CHECK(robot.error().code == ErrorCode::invalid);
  return robot.error().message;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("the only group that can move and is no end effector's is planned for") {
    const Robot::Parts parts = two_arms({{"hand", {"j4"}, true}, {"none", {}}, {"arm", {"j1"}}});
    CHECK(chosen(parts) == Names{"j1"});
    CHECK(chosen(two_arms({{"a", {"j1", "j2"}}, {"b", {"j1", "j2"}}})) == Names{"j1", "j2"});
  }

  TEST_CASE("a group or a chain can be named, and names of joints win over both") {
    const Robot::Parts parts = two_arms({{"left", {"j1", "j2"}}, {"hand", {"j4"}, true}});
    CHECK(chosen(parts, group_named("hand")) == Names{"j4"});
    CHECK(chosen(parts, group_named("l0:l3")) == Names{"j3"});
    CHECK(chosen(parts, group_named("l2:l0")) == Names{"j1", "j2"});
    CHECK(chosen(parts, group_named("l2:l3")) == Names{"j1", "j2", "j3"});
    RobotOptions both = group_named("left");
    both.joints = {"j4", "j3"};
    CHECK(chosen(parts, both) == Names{"j4", "j3"});
  }

  TEST_CASE("chains leave out fixed joints and joints that follow others") {
    Robot::Parts parts = test::make_chain(4);
    parts.joints[1].type = JointType::fixed;
    parts.joints[2].mimic = test::follow(0);
    CHECK(chosen(parts, group_named("l0:l4")) == Names{"j1", "j4"});
  }

  TEST_CASE("several groups and none named is an error that lists them") {
    CHECK(contains(refusal(two_arms({{"left", {"j1"}}, {"right", {"j3"}}})),
                   "several groups that can be planned for: left, right; name one"));
  }

  TEST_CASE("groups that cannot be planned for are errors") {
    const Robot::Parts parts = two_arms({{"none", {}}, {"hand", {"j4"}, true}});
    CHECK(contains(refusal(parts), "no group of the SRDF (none, hand) can move"));
    CHECK(contains(refusal(parts, group_named("none")), "group 'none' has no joint"));
    CHECK(contains(refusal(parts, group_named("arm")),
                   "there is no group 'arm'; expected none, hand or the two links of a chain"));
    CHECK(contains(refusal(two_arms(), group_named("l0:l9")),
                   "there is no group 'l0:l9'; expected the two links of a chain"));
    CHECK(contains(refusal(two_arms(), group_named("l1:l1")), "group 'l1:l1' has no joint"));
    CHECK(contains(refusal(two_arms(), group_named(":")), "there is no group ':'"));
  }
}

}  // namespace mneme
