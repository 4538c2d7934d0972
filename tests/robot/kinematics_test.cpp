// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/kinematics.h"
#include "robot/small_robots.h"
#include "support/support.h"

#include <cmath>
#include <vector>

namespace mneme {

using test::kPi;

TEST_SUITE("unit") {
  TEST_CASE("a prismatic joint shifts its link along the axis of its turned frame") {
    Robot::Parts parts = test::make_chain(1, JointType::prismatic);
    parts.joints[0].origin.rotation = rotation_from_rpy(Vec3(0, 0, kPi / 2));
    parts.joints[0].axis = Vec3(2, 0, 0);
    const Robot robot = test::require_robot(parts);
    const std::vector<double> q{0.25};
    CHECK((robot.link_poses(q)[1].translation - Vec3(1, 0.25, 0)).norm() < 1e-15);
  }

  TEST_CASE("a joint about a slanted axis turns its link about that axis") {
    Robot::Parts parts = test::make_chain(1);
    parts.joints[0].axis = Vec3(1, 1, 1);
    const Robot robot = test::require_robot(parts);
    // A third of a turn about the space diagonal takes x to y.
    const std::vector<double> q{2 * kPi / 3};
    CHECK((robot.link_poses(q)[1] * Vec3(1, 0, 0) - Vec3(1, 1, 0)).norm() < 1e-15);
  }

  TEST_CASE("a joint outside the group stands at its fixed value") {
    RobotOptions options;
    options.joints = {"j2"};
    options.fixed_values = {{"j1", kPi / 2}};
    const Robot robot = test::require_robot(test::make_chain(2), options);
    const std::vector<double> q{0.0};
    CHECK((robot.link_poses(q)[2].translation - Vec3(1, 1, 0)).norm() < 1e-15);
  }

  TEST_CASE("values go to joints in the order of the group") {
    RobotOptions options;
    options.joints = {"j2", "j1"};
    const Robot robot = test::require_robot(test::make_chain(2), options);
    const std::vector<double> q{0.0, kPi / 2};
    CHECK((robot.link_poses(q)[2].translation - Vec3(1, 1, 0)).norm() < 1e-15);
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("the planar arm's link origins are sums of lengths along summed angles") {
    const Robot robot = test::planar8();
    const std::vector<double> lengths{1.6, 1.4, 1.8, 1.2, 1.5, 1.3, 1.1, 1.7};
    Rng rng(11);
    for (int repetition = 0; repetition < 200; ++repetition) {
      const Configuration q = test::random_configuration(robot, rng);
      const std::vector<Transform> poses = robot.link_poses(q);
      CHECK(poses[0].translation.norm() == 0);
      double x = 0, y = 0, angle = 0;
      for (std::size_t i = 0; i < lengths.size(); ++i) {
        CHECK((poses[i + 1].translation - Vec3(x, y, 0)).norm() < 1e-13);
        angle += q[i];
        x += lengths[i] * std::cos(angle);
        y += lengths[i] * std::sin(angle);
        const Capsule& capsule = robot.links()[i + 1].capsules.at(0);
        const Vec3 tip = poses[i + 1] * capsule.b;
        CHECK((tip - Vec3(x, y, 0)).norm() < 1e-13);
      }
    }
  }
}

TEST_SUITE("law") {
  TEST_CASE("poses are rigid and joint 1 turns the whole arm") {
    const Robot robot = test::planar8();
    Rng rng(12);
    for (int repetition = 0; repetition < 100; ++repetition) {
      Configuration q = test::random_configuration(robot, rng);
      const std::vector<Transform> before = robot.link_poses(q);
      const double turn = rng.uniform(-kPi, kPi);
      q[0] += turn;
      const std::vector<Transform> after = robot.link_poses(q);
      const Eigen::Matrix3d rotation = rotation_about(Vec3::UnitZ(), turn);
      for (std::size_t i = 1; i < before.size(); ++i) {
        const Eigen::Matrix3d& r = before[i].rotation;
        CHECK((r * r.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-14);
        CHECK((after[i].translation - rotation * before[i].translation).norm() < 1e-13);
      }
    }
  }
}

}  // namespace mneme
