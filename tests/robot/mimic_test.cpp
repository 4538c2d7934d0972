// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/robot_tree.h"
#include "robot/small_robots.h"
#include "support/support.h"

#include <cmath>
#include <string>
#include <vector>

namespace mneme {
namespace {

using internal::fold_mimics;
using test::contains;
using test::follow;
using test::make_chain;

/// The fault of a chain of four joints after `change`.
template <class Change>
std::string refusal(Change change) {
  Robot::Parts parts = make_chain(4);
  change(parts.joints);
  const auto robot = make_robot(std::move(parts));
  REQUIRE_FALSE(robot.has_value());
  return robot.error().message;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a chain of followers is folded into one step") {
    std::vector<Joint> joints = make_chain(4).joints;
    joints[0].mimic = follow(1, 2, 0.1);
    joints[1].mimic = follow(2, 3, 0.2);
    joints[2].mimic = follow(3, -1, 0.3);
    CHECK_FALSE(fold_mimics(joints).has_value());
    // 2 (3 (-q + 0.3) + 0.2) + 0.1
    CHECK(joints[0].mimic->joint == 3);
    CHECK(joints[0].mimic->multiplier == -6);
    CHECK(joints[0].mimic->offset == doctest::Approx(2.3));
    CHECK(joints[1].mimic->joint == 3);
    CHECK_FALSE(joints[3].mimic.has_value());
  }

  TEST_CASE("a fixed joint follows none, but may be followed") {
    std::vector<Joint> joints = make_chain(3).joints;
    joints[0].type = JointType::fixed;
    joints[0].mimic = follow(1);
    joints[2].mimic = follow(0, 5, 0.5);
    CHECK_FALSE(fold_mimics(joints).has_value());
    CHECK_FALSE(joints[0].mimic.has_value());
    CHECK(joints[2].mimic->joint == 0);
    CHECK(internal::find_moving(joints, std::vector{1}) == std::vector{false, true, false});
  }

  TEST_CASE("joints that cannot follow are refused by name") {
    CHECK(contains(refusal([](auto& j) { j[1].mimic = follow(1); }),
                   "joint 'j2': the joints that it follows form a loop"));
    CHECK(contains(refusal([](auto& j) {
                     j[1].mimic = follow(2);
                     j[2].mimic = follow(1);
                   }),
                   "joint 'j2': the joints that it follows form a loop"));
    CHECK(contains(refusal([](auto& j) { j[1].mimic = follow(9); }), "joint 'j2': it follows"));
    CHECK(contains(refusal([](auto& j) { j[1].mimic = follow(0, std::nan("")); }),
                   "joint 'j2': its multiplier nan"));
    CHECK(contains(refusal([](auto& j) {
                     j[1].mimic = follow(0, 1e200);
                     j[2].mimic = follow(1, 1e200);
                   }),
                   "joint 'j3': its multiplier inf"));
  }

  TEST_CASE("what follows a continuous joint must not jump where that wraps round") {
    const auto follow_continuous = [](JointType type, double multiplier) {
      Robot::Parts parts = make_chain(2);
      parts.joints[0].type = JointType::continuous;
      parts.joints[1].type = type;
      parts.joints[1].mimic = follow(0, multiplier);
      return make_robot(std::move(parts));
    };
    CHECK(follow_continuous(JointType::revolute, -2).has_value());
    const auto half = follow_continuous(JointType::revolute, 0.5);
    REQUIRE_FALSE(half.has_value());
    CHECK(contains(half.error().message, "joint 'j2': it jumps where the continuous joint 'j1'"));
    CHECK_FALSE(follow_continuous(JointType::prismatic, 1).has_value());
  }

  TEST_CASE("joints that follow the group move, those that follow others stand still") {
    Robot::Parts parts = make_chain(4);
    parts.joints[1].mimic = follow(0, 0.5, 0.25);
    parts.joints[3].mimic = follow(2, 2, 0.1);
    const Robot robot = test::require_robot(parts, test::plan_for({"j1"}, {{"j3", 0.3}}));
    CHECK(robot.joints()[3].fixed_value == doctest::Approx(0.7));
    const double q = 0.4;
    const Transform tip = robot.link_poses(std::vector{q})[4];
    const double angle = q + (0.5 * q + 0.25) + 0.3 + 0.7;
    CHECK(tip.rotation.isApprox(rotation_about(Vec3::UnitZ(), angle)));
  }

  TEST_CASE("followers are neither planned for nor fixed by name") {
    Robot::Parts parts = make_chain(3);
    parts.joints[1].mimic = follow(0);
    CHECK(test::require_robot(parts).joint_count() == 2);
    for (const RobotOptions& options :
         {test::plan_for({"j2"}), test::plan_for({"j1"}, {{"j2", 0.5}})}) {
      const auto robot = make_robot(parts, options);
      REQUIRE_FALSE(robot.has_value());
      CHECK(contains(robot.error().message,
                     "joint 'j2' follows joint 'j1'; the movable joints "
                     "are: j1, j3"));
    }
  }
}

}  // namespace mneme
