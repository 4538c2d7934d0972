// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/body_points.h"
#include "support/lifting_arm.h"

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("what only the lift carries is no part of the arm") {
    const std::vector<bool> is_arm = internal::arm_links(lifting_arm());
    CHECK(is_arm == std::vector<bool>{false, false, true, true, true, false});
  }

  TEST_CASE("a capsule becomes a row of balls no further apart than its radius") {
    for (const internal::BodyPoint& point : internal::body_points(lifting_arm())) {
      CHECK(point.radius > 0);
      CHECK(point.joints.front() == 0);
    }
    const auto points = internal::body_points(lifting_arm());
    // The column's ball, nine of the upper arm, twelve and one of the forearm.
    CHECK(points.size() == 1 + 9 + 12 + 1);
    CHECK(points.front().joints == std::vector<int>{0, 1});
    CHECK(points.back().joints == std::vector<int>{0, 1, 2, 3});
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("the jacobian agrees with differences") {
    const Robot robot = lifting_arm();
    const auto points = internal::body_points(robot);
    Rng rng(75);
    constexpr double kStep = 1e-6;
    for (int i = 0; i < 40; ++i) {
      const Configuration q = random_configuration(robot, rng);
      const auto poses = robot.link_poses(q);
      const auto& point = points[rng.index(static_cast<std::uint32_t>(points.size()))];
      const auto at = [&](const std::vector<Transform>& where) {
        return Vec3(where[static_cast<std::size_t>(point.link)] * point.center);
      };
      const Eigen::Matrix3Xd rows = internal::jacobian(robot, poses, point, at(poses));
      for (int j = 0; j < robot.joint_count(); ++j) {
        Configuration further = q;
        further[static_cast<std::size_t>(j)] += kStep;
        const Vec3 slope = (at(robot.link_poses(further)) - at(poses)) / kStep;
        REQUIRE((slope - rows.col(j)).norm() < 1e-5);
      }
    }
  }
}

}  // namespace mneme::test
