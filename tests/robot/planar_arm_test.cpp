// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/small_robots.h"
#include "support/support.h"

#include <cmath>
#include <string>
#include <vector>

namespace mneme {
namespace {

const std::vector<double> kPlanar8{1.6, 1.4, 1.8, 1.2, 1.5, 1.3, 1.1, 1.7};

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("planar8.urdf is what the generator writes") {
    const auto urdf = planar_arm_urdf("planar8", kPlanar8);
    REQUIRE(urdf.has_value());
    CHECK(*urdf == test::read_file(test::source_file("robots/planar8.urdf")));
  }

  TEST_CASE("the arm has the stated links, joints and limits") {
    const Robot arm = test::planar8();
    CHECK(arm.name() == "planar8");
    CHECK(arm.is_planar());
    CHECK(arm.links()[0].name == "base");
    CHECK(arm.links()[0].capsules.empty());
    REQUIRE(arm.joint_count() == 8);
    for (int i = 0; i < 8; ++i) {
      const Joint& joint = arm.group_joint(i);
      CHECK(joint.name == "joint_" + std::to_string(i + 1));
      CHECK(joint.type == (i == 0 ? JointType::continuous : JointType::revolute));
      CHECK(joint.lower == -test::kPi);
      CHECK(joint.upper == test::kPi);
      const Link& link = arm.links()[static_cast<std::size_t>(joint.child_link)];
      CHECK(link.name == "link_" + std::to_string(i + 1));
      REQUIRE(link.capsules.size() == 1);
      CHECK(link.capsules[0].radius == 0.0005);
      CHECK(link.capsules[0].a.norm() < 1e-15);
      const Vec3 tip(kPlanar8[static_cast<std::size_t>(i)], 0, 0);
      CHECK((link.capsules[0].b - tip).norm() < 1e-15);
    }
    CHECK(arm.self_pairs().size() == 21);
  }

  TEST_CASE("an arm of any number of links and any name can be read back") {
    for (const std::size_t count : {std::size_t{1}, std::size_t{2}, std::size_t{50}}) {
      const auto urdf = planar_arm_urdf("<\"a&b'>", std::vector<double>(count, 1.0 / 3), 0.2);
      REQUIRE(urdf.has_value());
      const auto robot = parse_robot(*urdf, "arm.urdf");
      REQUIRE_MESSAGE(robot.has_value(), (robot ? "" : robot.error().message));
      CHECK(robot->name() == "<\"a&b'>");
      CHECK(robot->joint_count() == static_cast<int>(count));
      CHECK(robot->links().back().capsules[0].radius == 0.1);
      const auto poses = robot->link_poses(Configuration(count, 0.0));
      CHECK(poses.back().translation.x() == doctest::Approx(static_cast<double>(count - 1) / 3));
    }
  }

  TEST_CASE("lengths and thickness that are not positive are refused") {
    CHECK_FALSE(planar_arm_urdf("arm", {}).has_value());
    CHECK_FALSE(planar_arm_urdf("", kPlanar8).has_value());
    CHECK_FALSE(planar_arm_urdf("arm", kPlanar8, 0).has_value());
    for (const double bad : std::vector<double>{0, -1, NAN, INFINITY}) {
      const auto urdf = planar_arm_urdf("arm", std::vector{1.0, bad});
      REQUIRE_FALSE(urdf.has_value());
      CHECK(urdf.error().code == ErrorCode::invalid);
      CHECK(test::contains(urdf.error().message, "length of link 2"));
    }
  }
}

}  // namespace mneme
