// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/skeleton.h"

#include "report/report_support.h"

namespace mneme::internal {
namespace {

TEST_SUITE("unit") {
  TEST_CASE("The points of a planar arm are its joints and its end") {
    const Skeleton skeleton(test::unit_arm(3));
    const std::vector<Vec3> points = skeleton.points(Configuration{0, M_PI / 2, 0});
    const std::vector<Vec3> expected = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 2, 0}};
    REQUIRE(points.size() == expected.size());
    for (std::size_t i = 0; i < points.size(); ++i) CHECK((points[i] - expected[i]).norm() < 1e-12);
  }

  TEST_CASE("The tip of a gripper is between its fingers, whatever follows the last joint") {
    Robot::Parts parts;
    parts.name = "gripper";
    for (const char* name : {"base", "palm", "left", "right"})
      parts.links.emplace_back().name = name;
    const auto join = [&](int parent, int child, JointType type, const Vec3& offset) {
      Joint& joint = parts.joints.emplace_back();
      joint.name = "to_" + std::to_string(child);
      joint.type = type;
      joint.parent_link = parent;
      joint.child_link = child;
      joint.origin.translation = offset;
      joint.lower = -1;
      joint.upper = 1;
    };
    join(0, 1, JointType::revolute, Vec3(0, 0, 1));
    join(1, 2, JointType::fixed, Vec3(0.2, 0.05, 0));
    join(1, 3, JointType::fixed, Vec3(0.2, -0.05, 0));
    parts.links[1].spheres = {{Vec3(0.05, 0, 0), 0.04}};
    parts.links[2].spheres = {{Vec3::Zero(), 0.01}};
    parts.links[3].spheres = {{Vec3::Zero(), 0.01}};
    const auto robot = make_robot(std::move(parts));
    REQUIRE(robot.has_value());
    const Configuration rest = {0};
    const Vec3 tip = Skeleton(*robot).tip(robot->link_poses(rest));
    CHECK((tip - Vec3(0.2, 0, 1)).norm() < 1e-12);
  }
}

}  // namespace
}  // namespace mneme::internal
