// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/robot_tree.h"
#include "robot/small_robots.h"
#include "support/support.h"

#include <cmath>
#include <functional>
#include <string>
#include <vector>

namespace mneme {
namespace {

using internal::sort_tree;
using test::contains;
using test::kPi;
using test::make_chain;

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("parents come first, branches stay together, and joint i carries link i + 1") {
    Robot::Parts parts = make_chain(4);
    // l4 - l3 hang on l0 before l1 - l2.
    parts.joints = {test::make_joint("b", JointType::fixed, 4, 3),
                    test::make_joint("d", JointType::fixed, 1, 2),
                    test::make_joint("a", JointType::fixed, 0, 4),
                    test::make_joint("c", JointType::fixed, 0, 1)};
    const auto sorted = sort_tree(parts);
    REQUIRE(sorted.has_value());
    std::string joints, links;
    for (const Joint& joint : sorted->joints) joints += joint.name;
    for (const Link& link : sorted->links) links += link.name;
    CHECK(joints == "abcd");
    CHECK(links == "l0l4l3l1l2");
    for (int i = 0; i < 4; ++i) {
      CHECK(sorted->joints.at(static_cast<std::size_t>(i)).child_link == i + 1);
      CHECK(sorted->links.at(static_cast<std::size_t>(i + 1)).parent_joint == i);
    }
    CHECK(sorted->links[0].parent_joint == -1);
  }

  TEST_CASE("axes become unit vectors and continuous joints get the limits -pi and pi") {
    Robot::Parts parts = make_chain(1, JointType::continuous);
    parts.joints[0].axis = Vec3(0, 3, 4);
    const auto sorted = sort_tree(parts);
    REQUIRE(sorted.has_value());
    CHECK((sorted->joints[0].axis - Vec3(0, 0.6, 0.8)).norm() < 1e-15);
    CHECK(sorted->joints[0].lower == -kPi);
    CHECK(sorted->joints[0].upper == kPi);
  }

  TEST_CASE("what joints follow keeps its meaning when they are sorted") {
    Robot::Parts parts = make_chain(3);
    std::swap(parts.joints[0], parts.joints[2]);
    parts.joints[1].mimic = test::follow(0, 2);  // j2 follows j3
    const auto sorted = sort_tree(parts);
    REQUIRE(sorted.has_value());
    REQUIRE(sorted->joints[1].name == "j2");
    CHECK(sorted->joints[1].mimic->joint == 2);
    CHECK(sort_tree(*sorted)->joints[1].mimic->joint == 2);
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
           p.links[1].capsules = {{{}, {}, -1}};
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
      const auto sorted = sort_tree(parts);
      CAPTURE(i);
      REQUIRE_FALSE(sorted.has_value());
      CHECK_MESSAGE(contains(sorted.error().message, cases[i].message), sorted.error().message);
      CHECK(sorted.error().link == cases[i].link);
      CHECK(sorted.error().joint == cases[i].joint);
    }
  }

  TEST_CASE("a loop of all links is a loop and not a missing root") {
    Robot::Parts parts = make_chain(20);
    parts.joints.push_back(test::make_joint("closing", JointType::fixed, 20, 0));
    const auto sorted = sort_tree(parts);
    REQUIRE_FALSE(sorted.has_value());
    CHECK(contains(sorted.error().message, "21 joint(s) form a loop"));
    CHECK(contains(sorted.error().message, "..."));
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
      const auto once = sort_tree(parts);
      REQUIRE(once.has_value());
      const auto twice = sort_tree(*once);
      REQUIRE(twice.has_value());
      for (std::size_t i = 0; i < 30; ++i) {
        const Joint& joint = once->joints[i];
        CHECK(joint.parent_link < joint.child_link);
        CHECK(joint.name == twice->joints[i].name);
        CHECK(once->links[i].name == twice->links[i].name);
        // In make_chain joint j<n> carries link l<n>.
        CHECK(once->links.at(static_cast<std::size_t>(joint.child_link)).name.substr(1) ==
              joint.name.substr(1));
      }
    }
  }
}

}  // namespace mneme
