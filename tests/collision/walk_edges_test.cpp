// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/collision.h"

#include "collision/walking_robots.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <vector>

namespace mneme::test {
namespace {

/// Three slides that carry `link`, and another limb far away, which is the one that is pulled.
Robot slides_with(const std::vector<Sphere>& spheres, const std::vector<Capsule>& capsules) {
  Robot::Parts parts = parts_named("slides");
  for (const int axis : {0, 1, 2}) {
    hang_next(parts, JointType::prismatic, Vec3::Zero(), Vec3::Unit(axis), 2, {});
  }
  parts.links.back().spheres = spheres;
  parts.links.back().capsules = capsules;
  hang_link(parts, 0, joint_at(JointType::revolute, Vec3(0, 0, 10), Vec3::UnitZ(), -2, 2),
            {{Vec3(1, 0, 0), 0.05}}, {});
  return robot_of(parts);
}

/// How far the robot is from the obstacle after a step from the zero configuration that asks for
/// 0.02 m.
double clearance_after_step(const Robot& robot, const Shape& shape) {
  const Scene scene{"", {{"it", {shape}}}};
  OwnedStep step(robot, 1);
  step.clearance = 0.02f;
  const std::vector<float> from(static_cast<std::size_t>(robot.joint_count()), 0.0f);
  return clearance(robot, scene, step.take(require_checker(robot, scene), from));
}

TEST_SUITE("unit") {
  TEST_CASE("a long link that crosses the middle of a slanting capsule is pushed off it") {
    const Robot robot = slides_with({}, {{Vec3::Zero(), Vec3(1, 0, 0), 0.01}});
    const Vec3 middle(0.25, 0.015, 0), along(0.3, 0, 0.3);
    CHECK(clearance_after_step(robot, Capsule{middle - along, middle + along, 0.01}) > 0.01);
    CHECK(clearance_after_step(robot, Capsule{middle + along, middle - along, 0.01}) > 0.01);
  }

  TEST_CASE("what a step pushes off an obstacle does not go back to where it was") {
    const Robot robot = hand_and_pointer(false);
    Rng rng(17);
    int back = 0;
    for (int i = 0; i < 400; ++i) {
      // The centre of the ball of link 4 is 1 cm inside a sphere of 0.12 m.
      const Configuration q = {rng.uniform(-1, 1),
                               rng.uniform(-1, 1),
                               rng.uniform(-1, 1),
                               rng.uniform(-1.5, 1.5),
                               1.2,
                               0};
      const Vec3 ball = robot.link_poses(q)[4] * Vec3(0.25, 0, 0);
      const Vec3 normal = random_pose(rng, 1).rotation.col(0);
      const Scene scene{"", {{"it", {Sphere{ball - 0.11 * normal, 0.12}}}}};
      OwnedStep step(robot, 1);
      step.clearance = 0.02f;
      step.length = 0.01f;
      const std::vector<float> end = step.take(require_checker(robot, scene), to_row(q));
      double moved = 0;
      for (std::size_t j = 0; j < 5; ++j) moved = std::max(moved, std::abs(end[j] - q[j]));
      back += moved < 1e-4 ? 1 : 0;
    }
    CHECK(back == 0);
  }

  TEST_CASE("a limb with a slide between its points is as long as the way through them") {
    Robot::Parts parts = parts_named("telescope");
    hang_next(parts, JointType::revolute, Vec3::Zero(), Vec3::UnitZ(), 2,
              {{Vec3(0.2, 0, 0), 0.05}});
    hang_next(parts, JointType::prismatic, Vec3(0.5, 0, 0), Vec3::UnitX(), 0.2,
              {{Vec3(0.25, 0, 0), 0.05}});
    const std::vector<LimbInfo> limbs = require_checker(robot_of(parts), {}).limbs();
    REQUIRE(limbs.size() == 1);
    CHECK(limbs[0].length == doctest::Approx(0.75));
  }

  TEST_CASE("a limb that ends at the origin of a slide is a limb") {
    Robot::Parts parts = parts_named("crane");
    hang_next(parts, JointType::revolute, Vec3::Zero(), Vec3::UnitZ(), 2, {});
    hang_next(parts, JointType::prismatic, Vec3(0.5, 0, 0), -Vec3::UnitZ(), 0.5,
              {{Vec3::Zero(), 0.05}});
    CHECK(require_checker(robot_of(parts), {}).limbs().size() == 1);
  }
}

}  // namespace
}  // namespace mneme::test
