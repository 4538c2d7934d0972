// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/lifting_arm.h"

#include <algorithm>

namespace mneme::test {
namespace {

void check_joints(const Robot& robot, int turn, int lift, double axis_x = 0, double axis_y = 0) {
  const SymmetricJoints found = find_symmetric_joints(robot);
  INFO("robot ", robot.name());
  CHECK(found.turn == turn);
  CHECK(found.lift == lift);
  CHECK(found.axis_x == doctest::Approx(axis_x));
  CHECK(found.axis_y == doctest::Approx(axis_y));
}

Robot::Parts lone_base() {
  Robot::Parts parts;
  parts.name = "lone";
  Link base;
  base.name = "base";
  parts.links.push_back(base);
  return parts;
}

Joint turning(const Vec3& offset, const Vec3& axis) {
  return joint_at(JointType::revolute, offset, axis, -2, 2);
}
Joint lifting(const Vec3& offset, const Vec3& axis) {
  return joint_at(JointType::prismatic, offset, axis, 0, 1);
}

/// A chain of these joints, a sphere on each link.
Robot chain_of(const std::vector<Joint>& joints) {
  Robot::Parts parts = lone_base();
  for (std::size_t i = 0; i < joints.size(); ++i) {
    hang_link(parts, static_cast<int>(i), joints[i], {{Vec3(0.2, 0.1, 0), 0.02}}, {});
  }
  return robot_of(parts);
}

/// The links that all joints of the symmetry carry.
std::vector<int> moving_links(const Robot& robot, const SymmetricJoints& joints) {
  const int last = std::max(joints.turn, joints.lift);
  std::vector<int> moving;
  for (int link = 0; link < static_cast<int>(robot.links().size()); ++link) {
    int joint = robot.links()[static_cast<std::size_t>(link)].parent_joint;
    while (joint >= 0 && joint != robot.group()[static_cast<std::size_t>(last)]) {
      const int parent = robot.joints()[static_cast<std::size_t>(joint)].parent_link;
      joint = robot.links()[static_cast<std::size_t>(parent)].parent_joint;
    }
    if (joint >= 0) moving.push_back(link);
  }
  return moving;
}

double difference(const Transform& a, const Transform& b) {
  return (a.rotation - b.rotation).norm() + (a.translation - b.translation).norm();
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a planar arm turns about its base") { check_joints(planar8(), 0, -1); }

  TEST_CASE("a lift and a turn about an axis off the origin are found together") {
    check_joints(lifting_arm(), 1, 0, turning_axis().x(), turning_axis().y());
  }

  TEST_CASE("the turn may come before the lift, and either may be alone") {
    const Vec3 z = Vec3::UnitZ();
    const Joint shoulder = turning({0.1, 0, 0}, Vec3::UnitY());
    check_joints(chain_of({turning({1, 2, 0}, z), lifting({3, 0, 0}, z), shoulder}), 0, 1, 1, 2);
    check_joints(chain_of({turning({1, 2, 0}, z), shoulder}), 0, -1, 1, 2);
    check_joints(chain_of({lifting({1, 2, 0}, z), shoulder}), -1, 0);
    check_joints(chain_of({shoulder, turning({1, 0, 0}, z)}), -1, -1);
  }

  TEST_CASE("a joint that another one follows is no symmetry") {
    Robot::Parts parts;
    parts.name = "follower";
    parts.links.resize(3);
    for (int i = 0; i < 2; ++i) {
      parts.links[static_cast<std::size_t>(i)].name = i == 0 ? "base" : "arm";
      Joint joint = turning({0.1, 0, 0}, i == 0 ? Vec3(Vec3::UnitZ()) : Vec3(Vec3::UnitY()));
      joint.name = i == 0 ? "turn" : "finger";
      joint.parent_link = i;
      joint.child_link = i + 1;
      parts.joints.push_back(joint);
    }
    parts.links[1].parent_joint = 0;
    parts.links[2] = {"hand", 1, {{Vec3::Zero(), 0.1}}, {}, {}};
    CHECK(find_symmetric_joints(require(make_robot(parts))).turn == 0);
    parts.joints[1].mimic = Mimic{0, 1, 0};
    CHECK(find_symmetric_joints(require(make_robot(parts))).turn == -1);
  }

  TEST_CASE("of two turns or two lifts in a row the first counts") {
    const Vec3 z = Vec3::UnitZ();
    check_joints(chain_of({turning({1, 0, 0}, z), turning({1, 0, 0}, z), lifting({0, 0, 0}, z)}), 0,
                 -1, 1, 0);
    check_joints(chain_of({lifting({1, 0, 0}, z), lifting({1, 0, 0}, z), turning({1, 0, 0}, z)}),
                 -1, 0);
  }

  TEST_CASE("axes are those of the base, however the frames on the way are turned") {
    Joint tilted = turning({0.5, 0, 0}, Vec3::UnitY());
    tilted.origin.rotation = rotation_about(Vec3::UnitX(), kPi / 2);  // y to z
    check_joints(chain_of({tilted, turning({1, 0, 0}, Vec3::UnitZ())}), 0, -1, 0.5, 0);
    Joint slanted = turning({0.5, 0, 0}, Vec3::UnitZ());
    slanted.origin.rotation = rotation_about(Vec3::UnitX(), 0.01);
    check_joints(chain_of({slanted, turning({1, 0, 0}, Vec3::UnitZ())}), -1, -1);
  }

  TEST_CASE("joints that turn or lift the other way round are not taken") {
    check_joints(chain_of({turning({1, 0, 0}, -Vec3::UnitZ())}), -1, -1);
    check_joints(
        chain_of({lifting({1, 0, 0}, -Vec3::UnitZ()), turning(Vec3::Zero(), Vec3::UnitZ())}), -1,
        -1);
  }

  TEST_CASE("a joint that does not carry all others is not taken") {
    Robot::Parts parts = lifting_arm_parts();
    hang_link(parts, 1, turning({0, 0, 0.3}, Vec3::UnitZ()), {{Vec3(0.1, 0, 0), 0.02}}, {});
    const Robot with_head = robot_of(parts);
    REQUIRE(with_head.joint_count() == 5);
    CHECK(find_symmetric_joints(with_head).turn == -1);
    CHECK(with_head.group_joint(find_symmetric_joints(with_head).lift).name == "joint_1");

    Robot::Parts two_arms = lone_base();
    for (const double y : {-1, 1}) {
      hang_link(two_arms, 0, turning({0, y, 0}, Vec3::UnitZ()), {{Vec3(0.1, 0, 0), 0.02}}, {});
    }
    check_joints(robot_of(two_arms), -1, -1);
  }

  TEST_CASE("indices are those of a configuration, whatever the order of its joints") {
    check_joints(
        robot_of(lifting_arm_parts(), {.joints = {"joint_4", "joint_2", "joint_3", "joint_1"}}), 1,
        3, turning_axis().x(), turning_axis().y());
  }

  TEST_CASE("joints outside the planning group stand where they are fixed") {
    RobotOptions options;
    options.joints = {"joint_2", "joint_3", "joint_4"};
    options.fixed_values = {{"joint_1", 0.3}};
    check_joints(robot_of(lifting_arm_parts(), options), 0, -1, turning_axis().x(),
                 turning_axis().y());
    options.joints = {"joint_3", "joint_4"};
    check_joints(robot_of(lifting_arm_parts(), options), -1, -1);

    Robot::Parts parts = lone_base();
    hang_link(parts, 0, joint_at(JointType::prismatic, Vec3::Zero(), Vec3::UnitX(), 0, 1), {}, {});
    hang_link(parts, 1, turning({0, 0.5, 0}, Vec3::UnitZ()), {{Vec3(0.1, 0, 0), 0.02}}, {});
    options.joints = {"joint_2"};
    options.fixed_values = {{"joint_1", 0.75}};
    check_joints(robot_of(parts, options), 0, -1, 0.75, 0.5);
  }
}

TEST_SUITE("law") {
  TEST_CASE("moving a configuration moves the links that the symmetry carries, and no others") {
    const Vec3 z = Vec3::UnitZ();
    const std::vector<Robot> robots = {
        lifting_arm(), planar8(),
        chain_of({turning({1, 2, 0}, z), lifting({3, 0, 0}, z), turning({0, 1, 0}, {1, 0, 0})}),
        chain_of({lifting({1, 2, 0}, z), turning({0, 1, 0}, {1, 0, 0})})};
    Rng rng(31);
    for (const Robot& robot : robots) {
      const SymmetricJoints joints = find_symmetric_joints(robot);
      const std::vector<int> moving = moving_links(robot, joints);
      REQUIRE(moving.size() >= 2);
      for (int i = 0; i < 100; ++i) {
        Symmetry motion;
        if (joints.turn >= 0) motion.rotation = rng.uniform(-3, 3);
        if (joints.lift >= 0) motion.lift = rng.uniform(-1, 1);
        const Configuration q = random_configuration(robot, rng);
        const auto before = robot.link_poses(q);
        const auto after = robot.link_poses(moved_configuration(joints, motion, q));
        const Transform expected = transform_of(joints, motion);
        INFO("robot ", robot.name(), ", case ", i);
        for (const int link : moving) {
          const auto at = static_cast<std::size_t>(link);
          REQUIRE(difference(after[at], expected * before[at]) < 1e-9);
        }
        REQUIRE(difference(after[0], before[0]) == 0);
      }
    }
  }
}

TEST_SUITE("flow") {
  TEST_CASE("the robots that come with mneme have the symmetries that their builders gave them") {
    const auto shipped = [](const std::string& name) {
      return require(load_robot(source_file("robots/" + name + ".urdf")));
    };
    const Robot fetch = shipped("fetch");
    const SymmetricJoints of_fetch = find_symmetric_joints(fetch);
    REQUIRE(of_fetch.lift >= 0);
    REQUIRE(of_fetch.turn >= 0);
    CHECK(fetch.group_joint(of_fetch.lift).name == "torso_lift_joint");
    CHECK(fetch.group_joint(of_fetch.turn).name == "shoulder_pan_joint");
    for (const std::string name : {"panda", "ur5"}) check_joints(shipped(name), 0, -1);
  }
}

}  // namespace mneme::test
