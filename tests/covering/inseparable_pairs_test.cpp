// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "covering/allowed_pairs.h"
#include "support/support.h"

namespace mneme::test {
namespace {

/// Two links in line, each a ball at its joint; a ring of `radius` about the last one's axis.
Robot arm_with_ring(double radius) {
  Robot::Parts parts;
  parts.name = "ringed";
  parts.links.resize(3);
  parts.links[0] = {"base", -1, {{Vec3(0, 0, 0), 0.1}}, {}, {}};
  parts.links[1] = {"arm", 0, {{Vec3(0.5, 0, 0), 0.1}}, {}, {}};
  parts.links[2] = {"ring", 1, {{Vec3(radius, 0, 0), 0.1}}, {}, {}};
  parts.allowed_pairs.emplace();
  for (int i = 0; i < 2; ++i) {
    Joint joint;
    joint.name = i == 0 ? "swing" : "spin";
    joint.type = JointType::revolute;
    joint.parent_link = i;
    joint.child_link = i + 1;
    joint.origin.translation = Vec3(0.5 * i, 0, 0);
    joint.axis = i == 0 ? Vec3(Vec3::UnitZ()) : Vec3(Vec3::UnitX());
    joint.lower = -2;
    joint.upper = 2;
    parts.joints.push_back(joint);
  }
  const auto robot = make_robot(std::move(parts));
  REQUIRE_MESSAGE(robot.has_value(), (robot ? "" : robot.error().message));
  return *robot;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("links that touch however the joints turn are found") {
    const auto pairs = internal::find_inseparable_pairs(arm_with_ring(0.05));
    REQUIRE(pairs.size() == 1);
    CHECK(pairs.front() == std::pair<std::string, std::string>("arm", "ring"));
  }

  TEST_CASE("links that part in some configuration are not") {
    CHECK(internal::find_inseparable_pairs(arm_with_ring(0.3)).empty());
  }

  TEST_CASE("a robot whose links never touch has none") {
    CHECK(internal::find_inseparable_pairs(planar8()).empty());
  }
}

}  // namespace mneme::test
