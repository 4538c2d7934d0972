// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/kinematics.h"
#include "robot/planning_group.h"
#include "robot/robot_tree.h"
#include "robot/small_robots.h"
#include "support/support.h"

#include <functional>
#include <string>
#include <vector>

namespace mneme {
namespace {

using internal::sort_tree;
using test::contains;
using test::kPi;
using test::make_chain;
using test::refusal;
using test::require;
using test::require_error;

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("parents come first, branches stay together, and joint i carries link i + 1") {
    Robot::Parts parts = make_chain(4);
    // l4 - l3 hang on l0 before l1 - l2.
    parts.joints = {test::make_joint("b", JointType::fixed, 4, 3),
                    test::make_joint("d", JointType::fixed, 1, 2),
                    test::make_joint("a", JointType::fixed, 0, 4),
                    test::make_joint("c", JointType::fixed, 0, 1)};
    const auto sorted = require(sort_tree(parts));
    std::string joints, links;
    for (const Joint& joint : sorted.joints) joints += joint.name;
    for (const Link& link : sorted.links) links += link.name;
    CHECK(joints == "abcd");
    CHECK(links == "l0l4l3l1l2");
    for (int i = 0; i < 4; ++i) {
      CHECK(sorted.joints.at(static_cast<std::size_t>(i)).child_link == i + 1);
      CHECK(sorted.links.at(static_cast<std::size_t>(i + 1)).parent_joint == i);
    }
    CHECK(sorted.links[0].parent_joint == -1);
  }

  TEST_CASE("axes become unit vectors and continuous joints get the limits -pi and pi") {
    Robot::Parts parts = make_chain(1, JointType::continuous);
    parts.joints[0].axis = Vec3(0, 3, 4);
    const auto sorted = require(sort_tree(parts));
    CHECK((sorted.joints[0].axis - Vec3(0, 0.6, 0.8)).norm() < 1e-15);
    CHECK(sorted.joints[0].lower == -kPi);
    CHECK(sorted.joints[0].upper == kPi);
  }

  TEST_CASE("what joints follow keeps its meaning when they are sorted") {
    Robot::Parts parts = make_chain(3);
    std::swap(parts.joints[0], parts.joints[2]);
    parts.joints[1].mimic = test::follow(0, 2);  // j2 follows j3
    const auto sorted = require(sort_tree(parts));
    REQUIRE(sorted.joints[1].name == "j2");
    CHECK(sorted.joints[1].mimic->joint == 2);
    CHECK(sort_tree(sorted)->joints[1].mimic->joint == 2);
  }

  TEST_CASE("a fixed joint needs neither axis nor limits") {
    Robot::Parts parts = make_chain(1, JointType::fixed);
    parts.joints[0].axis = Vec3::Zero();
    parts.joints[0].lower = 5;
    CHECK(sort_tree(parts).has_value());
  }

  TEST_CASE("faults name what is wrong and the part that is to blame") {
    struct Case {
      std::function<void(Robot::Parts&)> break_parts;
      std::string message;
      int link, joint;
    };
    const std::vector<Case> cases{
        {[](auto& p) { p.links.clear(); }, "no link", -1, -1},
        {[](auto& p) { p.links.resize(5000); }, "5000 links", -1, -1},
        {[](auto& p) { p.links[2].name = "l0"; }, "link 'l0' is defined twice", 2, -1},
        {[](auto& p) { p.joints[2].name = "j1"; }, "joint 'j1' is defined twice", -1, 2},
        {[](auto& p) { p.joints[1].parent_link = 9; }, "joint 'j2': there is no link 9", -1, 1},
        {[](auto& p) { p.joints[1].axis.setZero(); }, "joint 'j2': its axis", -1, 1},
        {[](auto& p) { p.joints[1].axis *= 1e-10; }, "joint 'j2': its axis", -1, 1},
        {[](auto& p) { p.joints[0].upper = std::nan(""); }, "joint 'j1': its limits", -1, 0},
        {[](auto& p) { p.joints[0].lower = 2.5; }, "lower limit 2.5 is above its upper", -1, 0},
        {[](auto& p) { p.joints[0].origin.translation.x() = INFINITY; }, "origin", -1, 0},
        {[](auto& p) { p.links[1].spheres[0].radius = -1; }, "link 'l1': a sphere", 1, -1},
        {[](auto& p) { p.links[1].spheres[0].center.x() = NAN; }, "link 'l1': the centre", 1, -1},
        {[](auto& p) { p.links[1].spheres[0].center.x() = 1e308; }, "link 'l1': the centre", 1, -1},
        {[](auto& p) { p.links[1].spheres[0].radius = 1e7; }, "link 'l1': a sphere", 1, -1},
        {[](auto& p) { p.joints[0].origin.translation.x() = -1e7; }, "within 1000000 m", -1, 0},
        {[](auto& p) {
           p.links[1].capsules = {{Vec3::Zero(), Vec3::Zero(), -1}};
         },
         "link 'l1': a capsule", 1, -1},
        {[](auto& p) { p.joints[2].child_link = 1; }, "child of two joints, 'j1' and 'j3'", -1, 2},
        {[](auto& p) { p.joints.pop_back(); }, "several root links: neither 'l0' nor 'l3'", 3, -1},
        {[](auto& p) { p.joints[1].parent_link = 3; }, "2 joint(s) form a loop: 'j", -1, 1},
        {[](auto& p) { p.joints[0].parent_link = 1; }, "1 joint(s) form a loop: 'j1'", -1, 0},
    };
    for (std::size_t i = 0; i < cases.size(); ++i) {
      Robot::Parts parts = make_chain(3);
      cases[i].break_parts(parts);
      const auto error = require_error(sort_tree(parts));
      CAPTURE(i);
      CHECK_MESSAGE(contains(error.message, cases[i].message), error.message);
      CHECK(error.link == cases[i].link);
      CHECK(error.joint == cases[i].joint);
    }
  }

  TEST_CASE("a loop of all links is a loop and not a missing root") {
    Robot::Parts parts = make_chain(20);
    parts.joints.push_back(test::make_joint("closing", JointType::fixed, 20, 0));
    const auto error = require_error(sort_tree(parts));
    CHECK(contains(error.message, "21 joint(s) form a loop"));
    CHECK(contains(error.message, "..."));
  }
}

TEST_SUITE("law") {
  TEST_CASE("sorting what is sorted changes nothing, and random trees keep their joints") {
    Rng rng(31);
    for (int repetition = 0; repetition < 50; ++repetition) {
      Robot::Parts parts = make_chain(30);
      for (Joint& joint : parts.joints) {
        joint.parent_link =
            static_cast<int>(rng.index(static_cast<std::uint32_t>(joint.child_link)));
      }
      for (std::size_t i = 29; i > 0; --i) {
        std::swap(parts.joints[i], parts.joints[rng.index(static_cast<std::uint32_t>(i + 1))]);
      }
      const auto once = require(sort_tree(parts));
      const auto twice = require(sort_tree(once));
      for (std::size_t i = 0; i < 30; ++i) {
        const Joint& joint = once.joints[i];
        CHECK(joint.parent_link < joint.child_link);
        CHECK(joint.name == twice.joints[i].name);
        CHECK(once.links[i].name == twice.links[i].name);
        // In make_chain joint j<n> carries link l<n>.
        CHECK(once.links.at(static_cast<std::size_t>(joint.child_link)).name.substr(1) ==
              joint.name.substr(1));
      }
    }
  }
}

namespace {

using internal::fold_mimics;
using test::follow;

/// The fault of a chain of four joints after `change`.
template <class Change>
std::string refusal_of_changed(Change change) {
  Robot::Parts parts = make_chain(4);
  change(parts.joints);
  return refusal(parts);
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
    CHECK(contains(refusal_of_changed([](auto& j) { j[1].mimic = follow(1); }),
                   "joint 'j2': the joints that it follows form a loop"));
    CHECK(contains(refusal_of_changed([](auto& j) {
                     j[1].mimic = follow(2);
                     j[2].mimic = follow(1);
                   }),
                   "joint 'j2': the joints that it follows form a loop"));
    CHECK(contains(refusal_of_changed([](auto& j) { j[1].mimic = follow(9); }),
                   "joint 'j2': it follows"));
    CHECK(contains(refusal_of_changed([](auto& j) { j[1].mimic = follow(0, std::nan("")); }),
                   "joint 'j2': its multiplier nan"));
    CHECK(contains(refusal_of_changed([](auto& j) {
                     j[1].mimic = follow(0, 1e4);
                     j[2].mimic = follow(1, 1e4);
                   }),
                   "joint 'j2': with multiplier 10000, offset 0 and the limits of joint 'j1' it"));
    CHECK(
        contains(refusal_of_changed([](auto& j) { j[1].mimic = follow(0, 1, -1e7); }),
                 "joint 'j2': its multiplier 1 and offset -10000000 are not both within 1000000"));
    CHECK(contains(refusal_of_changed([](auto& j) { j[1].mimic = follow(0, 1, 2e4); }),
                   "joint 'j2': with multiplier 1, offset 20000 and the limits of joint 'j1' it "
                   "would move to 2"));
  }

  TEST_CASE("a follower of the group must not jump where its continuous leader wraps around") {
    const auto follow_continuous = [](JointType type, double multiplier,
                                      const RobotOptions& options = {}) {
      Robot::Parts parts = make_chain(3);
      parts.joints[0].type = JointType::continuous;
      parts.joints[1].type = type;
      parts.joints[1].mimic = follow(0, multiplier);
      return make_robot(std::move(parts), options);
    };
    CHECK(follow_continuous(JointType::revolute, -2).has_value());
    const auto half = follow_continuous(JointType::revolute, 0.5);
    REQUIRE_FALSE(half.has_value());
    CHECK(contains(half.error().message, "joint 'j2' jumps where the continuous joint 'j1'"));
    CHECK(contains(half.error().message, "plan for joints without it (--group, joints)"));
    CHECK_FALSE(follow_continuous(JointType::prismatic, 1).has_value());
    const auto held =
        follow_continuous(JointType::prismatic, 0.1, test::plan_for({"j3"}, {{"j1", 4}}));
    REQUIRE_MESSAGE(held.has_value(), (held ? "" : held.error().message));
    CHECK(held->joints()[1].fixed_value == doctest::Approx(0.4));
    CHECK(held->link_poses(std::vector{0.0})[2].translation.norm() ==
          doctest::Approx(
              (Vec3(1, 0, 0) + rotation_about(Vec3::UnitZ(), 4) * Vec3(1, 0, 0.4)).norm()));
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
      CHECK(contains(require_error(make_robot(parts, options)).message,
                     "joint 'j2' follows joint 'j1'; the movable joints "
                     "are: j1, j3"));
    }
  }
}

namespace {

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
                   "several groups to plan for: left, right; name one"));
  }

  TEST_CASE("groups that cannot be planned for are errors") {
    const Robot::Parts parts = two_arms({{"none", {}}, {"hand", {"j4"}, true}});
    CHECK(contains(refusal(parts), "no group of the SRDF (none, hand) is movable"));
    CHECK(contains(refusal(parts, group_named("none")), "group 'none' has no joint"));
    Robot::Parts misspelt = two_arms({{"arm", {}}});
    misspelt.warnings = {"arm.srdf:2: robot 'two_arms' has no link 'hnd'"};
    CHECK(contains(refusal(misspelt),
                   "joints to plan for; arm.srdf:2: robot 'two_arms' has no "
                   "link 'hnd'"));
    CHECK(contains(refusal(misspelt, group_named("arm")), "has no link 'hnd'"));
    CHECK(contains(refusal(parts, group_named("arm")),
                   "there is no group 'arm'; expected none, hand or the two links of a chain"));
    CHECK(contains(refusal(two_arms(), group_named("l0:l9")),
                   "there is no group 'l0:l9'; expected the two links of a chain"));
    CHECK(contains(refusal(two_arms(), group_named("l1:l1")), "group 'l1:l1' has no joint"));
    CHECK(contains(refusal(two_arms(), group_named(":")), "there is no group ':'"));
  }
}

}  // namespace mneme
