// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "check/contacts.h"
#include "collision/random_worlds.h"

#include <algorithm>
#include <string>
#include <vector>

namespace mneme::test {
namespace {

/// A post that stands still, and two links of 1 m, 5 cm in radius, that turn about z; the third
/// carries a ball.
constexpr const char* kArm = R"(<robot name="arm">
  <link name="post"><collision><origin xyz="0 0 -1"/>
    <geometry><capsule radius="0.1" length="1"/></geometry></collision></link>
  <link name="near"><collision><origin xyz="0.5 0 0" rpy="0 1.5707963267948966 0"/>
    <geometry><capsule radius="0.05" length="1"/></geometry></collision></link>
  <link name="far"><collision><origin xyz="0.5 0 0" rpy="0 1.5707963267948966 0"/>
    <geometry><capsule radius="0.05" length="1"/></geometry></collision></link>
  <link name="ball"><collision><origin xyz="1 0 0"/>
    <geometry><sphere radius="0.2"/></geometry></collision></link>
  <joint name="a" type="revolute"><parent link="post"/><child link="near"/>
    <axis xyz="0 0 1"/><limit lower="-3.2" upper="3.2"/></joint>
  <joint name="b" type="revolute"><parent link="near"/><child link="far"/>
    <origin xyz="1 0 0"/><axis xyz="0 0 1"/><limit lower="-3.2" upper="3.2"/></joint>
  <joint name="c" type="revolute"><parent link="far"/><child link="ball"/>
    <origin xyz="1 0 0"/><axis xyz="0 0 1"/><limit lower="-3.2" upper="3.2"/></joint>
</robot>)";

Scene ball_scene(const Vec3& center, double radius) {
  return {"s", {{"lamp", {Sphere{{9, 9, 9}, 0.1}}}, {"cup", {Sphere{center, radius}}}}};
}

std::vector<std::string> named(const std::vector<Contact>& contacts) {
  std::vector<std::string> names;
  for (const Contact& contact : contacts) names.push_back(contact.link + " " + contact.other);
  return names;
}

using Names = std::vector<std::string>;

TEST_SUITE("unit") {
  TEST_CASE("a contact names the link and the obstacle and says how deep it is") {
    const Robot arm = require_parsed(kArm);
    const auto contacts =
        internal::find_contacts(arm, ball_scene({1.5, 0.3, 0}, 0.27), Configuration{0, 0, 0}, 0);
    REQUIRE(contacts.size() == 1);
    CHECK(contacts[0].link == "far");
    CHECK(contacts[0].other == "cup");
    CHECK(!contacts[0].is_self);
    CHECK(contacts[0].distance == doctest::Approx(-0.02));
  }

  TEST_CASE("every link that touches is named") {
    const Robot arm = require_parsed(kArm);
    const auto contacts =
        internal::find_contacts(arm, ball_scene({1, 0, 0}, 0.1), Configuration{0, 0, 0}, 0);
    CHECK(named(contacts) == Names{"near cup", "far cup"});
  }

  TEST_CASE("within the margin an obstacle counts, with the distance that it has") {
    const Robot arm = require_parsed(kArm);
    const Scene scene = ball_scene({0.5, 0, 0.5}, 0.1);
    const Configuration q = {0, 0, 0};
    CHECK(internal::find_contacts(arm, scene, q, 0.34).empty());
    const auto contacts = internal::find_contacts(arm, scene, q, 0.36);
    REQUIRE(named(contacts) == Names{"near cup"});
    CHECK(contacts[0].distance == doctest::Approx(0.35));
  }

  TEST_CASE("links joined by one joint are not in contact, even folded onto each other") {
    const Robot arm = require_parsed(kArm);
    CHECK(internal::find_contacts(arm, {}, Configuration{0, kPi, 0}, 0).empty());
    CHECK(internal::find_contacts(arm, {}, Configuration{0, 0, 0}, 10).empty());
  }

  TEST_CASE("surfaces that only just touch are not in contact") {
    const Robot arm = require_parsed(kArm);
    // The ball link is 0.2 m in radius about (3, 0, 0).
    const auto touches = [&](double x) {
      return !internal::find_contacts(arm, ball_scene({x, 0, 0}, 0.8), Configuration{0, 0, 0}, 0)
                  .empty();
    };
    CHECK(touches(4 - 1e-12));
    CHECK(!touches(4 + 1e-12));
  }

  TEST_CASE("a link that touches another is named with it") {
    const Robot arm = require_parsed(kArm);
    // Folded back, the ball is at the near link's first joint; the post stands further below.
    const auto contacts = internal::find_contacts(arm, {}, Configuration{0, kPi, kPi}, 0);
    REQUIRE(named(contacts) == Names{"near ball"});
    CHECK(contacts[0].is_self);
    CHECK(contacts[0].distance == doctest::Approx(-0.25));
  }

  TEST_CASE("a link that stands still is named, and blocks the robot") {
    const Robot arm = require_parsed(kArm);
    const Scene scene = ball_scene({0.2, 0, -1}, 0.15);
    CHECK(named(internal::find_contacts(arm, scene, Configuration{1, 1, 1}, 0)) ==
          Names{"post cup"});
    CHECK(fixed_clearance(arm, scene) < 0);
    CHECK(!(fixed_clearance(arm, ball_scene({0.2, 0, -1}, 0.05)) < 0));
    CHECK(fixed_clearance(arm, ball_scene({0.2, 0, -1}, 0.05)) < 0.06);
    CHECK(!(fixed_clearance(arm, ball_scene({0.5, 0, 0}, 0.05)) < 0));
  }

  TEST_CASE("a link that is welded to a moving one does not stand still") {
    Robot::Parts parts;
    parts.name = "welded";
    parts.links = {{"base", -1, {}, {}, {}},
                   {"arm", -1, {}, {}, {}},
                   {"tool", -1, {{{1, 0, 0}, 0.1}}, {}, {}}};
    for (int i = 0; i < 2; ++i) {
      Joint joint;
      joint.name = "joint" + std::to_string(i);
      joint.type = i == 0 ? JointType::continuous : JointType::fixed;
      joint.parent_link = i;
      joint.child_link = i + 1;
      parts.joints.push_back(joint);
    }
    const auto robot = make_robot(parts);
    REQUIRE(robot.has_value());
    const Scene scene = ball_scene({1, 0, 0}, 0.1);
    CHECK(named(internal::find_contacts(*robot, scene, Configuration{0}, 0)) == Names{"tool cup"});
    CHECK(!(fixed_clearance(*robot, scene) < 0));
  }

  TEST_CASE("an empty scene holds no contact") {
    const Robot arm = require_parsed(kArm);
    CHECK(internal::find_contacts(arm, {}, Configuration{0, 1, 1}, 0).empty());
    CHECK(!(fixed_clearance(arm, {}) < 1));
  }
}

TEST_SUITE("law") {
  TEST_CASE("contacts move with the world") {
    Rng rng(401);
    int found = 0;
    for (int i = 0; i < 30; ++i) {
      const Robot robot = random_robot(rng);
      const Scene scene = random_scene(robot, 5, rng, small_shape);
      const Transform X = random_pose(rng, 1.0);
      Robot::Parts parts{"moved", {{"ground", -1, {}, {}, {}}}, {}};
      for (Link link : robot.links()) parts.links.push_back(link);
      Joint mount;
      mount.name = "mount";
      mount.parent_link = 0;
      mount.child_link = 1;
      mount.origin = X;
      parts.joints.push_back(mount);
      for (Joint joint : robot.joints()) {
        ++joint.parent_link;
        ++joint.child_link;
        if (joint.mimic) ++joint.mimic->joint;
        parts.joints.push_back(joint);
      }
      RobotOptions options;
      for (int k = 0; k < robot.joint_count(); ++k)
        options.joints.push_back(robot.group_joint(k).name);
      for (const Joint& joint : robot.joints()) {
        if (joint.type == JointType::fixed || joint.mimic) continue;
        options.fixed_values[joint.name] = joint.fixed_value;
      }
      for (const std::string& name : options.joints) options.fixed_values.erase(name);
      const auto moved = make_robot(parts, options);
      REQUIRE_MESSAGE(moved.has_value(), (moved ? "" : moved.error().message));
      Scene moved_scene = scene;
      for (Obstacle& obstacle : moved_scene.obstacles) {
        obstacle.shapes[0] = transformed(X, obstacle.shapes[0]);
      }
      for (int k = 0; k < 50; ++k) {
        const Configuration q = random_configuration(robot, rng);
        const auto here = internal::find_contacts(robot, scene, q, 0.02);
        const auto there = internal::find_contacts(*moved, moved_scene, q, 0.02);
        INFO("seed 401, robot " << i << ", state " << k);
        REQUIRE(named(here) == named(there));
        for (std::size_t c = 0; c < here.size(); ++c) {
          REQUIRE(std::abs(here[c].distance - there[c].distance) < 1e-12);
          ++found;
        }
      }
    }
    CHECK(found > 300);
  }

  TEST_CASE("a state has contacts where its clearance is negative") {
    Rng rng(402);
    int in_contact = 0;
    for (int i = 0; i < 30; ++i) {
      const Robot robot = random_robot(rng);
      const Scene scene = random_scene(robot, 4, rng, small_shape);
      const double margin = i % 2 == 0 ? 0.0 : 0.1;
      for (int k = 0; k < 100; ++k) {
        const Configuration q = random_configuration(robot, rng);
        const auto contacts = internal::find_contacts(robot, scene, q, margin);
        REQUIRE(contacts.empty() == (clearance(robot, scene, q, margin) >= 0));
        in_contact += contacts.empty() ? 0 : 1;
        for (const Contact& contact : contacts) {
          REQUIRE(contact.distance < (contact.is_self ? 0 : margin));
        }
      }
    }
    CHECK(in_contact > 300);
    CHECK(in_contact < 2700);
  }
}

}  // namespace
}  // namespace mneme::test
