// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// The robots that come with mneme, against facts about their kinematics (see robots/SOURCE.md).
#include "robot/small_robots.h"
#include "support/support.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <string>
#include <vector>

namespace mneme {
namespace {

/// Where `tip` is in `base` at `q`: position, and quaternion as x, y, z, w.
struct TipPose {
  std::vector<double> q;
  Vec3 position;
  Eigen::Quaterniond rotation;
};

struct Facts {
  std::string file, base, tip;
  std::vector<std::string> joints;
  std::vector<TipPose> poses;
};

Eigen::Quaterniond xyzw(double x, double y, double z, double w) { return {w, x, y, z}; }

std::vector<Facts> all_facts() {
  return {
      {"fetch",
       "base_link",
       "gripper_link",
       {"torso_lift_joint", "shoulder_pan_joint", "shoulder_lift_joint", "upperarm_roll_joint",
        "elbow_flex_joint", "forearm_roll_joint", "wrist_flex_joint", "wrist_roll_joint"},
       {{{0, 0, 0, 0, 0, 0, 0, 0}, {1.1281, 0, 0.78601}, xyzw(0, 0, 0, 1)},
        {{0.1, 1.32, 1.4, -0.2, 1.72, 0, 1.66, 0},
         {0.050403, -0.127560, 0.837277},
         xyzw(0.459821, -0.503129, 0.511642, 0.523114)},
        {{0.38615, 0.5, -0.5, 1, 1, -1, 1, 2},
         {0.566044, 0.622623, 1.021956},
         xyzw(0.373028, 0.612634, -0.064775, 0.693782)}}},
      {"panda",
       "panda_link0",
       "panda_hand",
       {"panda_joint1", "panda_joint2", "panda_joint3", "panda_joint4", "panda_joint5",
        "panda_joint6", "panda_joint7"},
       {{{0, 0, 0, 0, 0, 0, 0}, {0.088, 0, 0.926}, xyzw(0.923880, 0.382683, 0, 0)},
        {{0, -0.785, 0, -2.356, 0, 1.571, 0.785}, {0.307020, 0, 0.590270}, xyzw(1, 0.000199, 0, 0)},
        {{2.35, 1, 0, -0.8, 0, 2.5, 0.785},
         {-0.589871, 0.597224, 0.402264},
         xyzw(-0.361996, -0.866822, -0.132265, 0.316362)}}},
      {"ur5",
       "base_link",
       "tool0",
       {"shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint",
        "wrist_2_joint", "wrist_3_joint"},
       {{{0, 0, 0, 0, 0, 0}, {0.817250, 0.191450, -0.005491}, xyzw(0, 0.707107, 0.707107, 0)},
        {{0, -1.57, 0, -1.57, 0, 0},
         {0.000802, 0.191450, 1.001059},
         xyzw(-0.707107, 0.000563, 0.000563, 0.707107)},
        {{0.5, -1, 1, -0.5, 0.7, 0.3},
         {0.543898, 0.493236, 0.389140},
         xyzw(0.011977, 0.587732, 0.803515, 0.093760)}}},
  };
}

Robot::Parts require_parts(const std::string& file) {
  auto parts = read_robot(test::source_file(file));
  REQUIRE_MESSAGE(parts.has_value(), (parts ? "" : parts.error().message));
  CHECK(parts->warnings.empty());
  return *std::move(parts);
}

std::size_t index_of(const Robot& robot, const std::string& link) {
  const auto found = std::ranges::find(robot.links(), link, &Link::name);
  REQUIRE(found != robot.links().end());
  return static_cast<std::size_t>(found - robot.links().begin());
}

void check_poses(const Robot& robot, const Facts& facts) {
  std::vector<std::string> joints;
  for (int i = 0; i < robot.joint_count(); ++i) joints.push_back(robot.group_joint(i).name);
  CHECK(joints == facts.joints);
  for (const TipPose& pose : facts.poses) {
    CHECK_FALSE(robot.describe_violation(pose.q, "configuration").has_value());
    const std::vector<Transform> poses = robot.link_poses(pose.q);
    const Transform X_base_tip =
        poses[index_of(robot, facts.base)].inverse() * poses[index_of(robot, facts.tip)];
    CHECK((X_base_tip.translation - pose.position).norm() < 2e-6);
    CHECK(Eigen::Quaterniond(X_base_tip.rotation).angularDistance(pose.rotation) < 5e-6);
  }
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("the sources of the robots have the kinematics of the facts") {
    for (const Facts& facts : all_facts()) {
      CAPTURE(facts.file);
      Robot::Parts parts = require_parts("robots/source/" + facts.file + ".urdf");
      for (Link& link : parts.links) link.solids.clear();
      check_poses(test::require_robot(parts), facts);
    }
  }

  TEST_CASE("the robots have the kinematics of the facts and one group to plan for") {
    for (const Facts& facts : all_facts()) {
      CAPTURE(facts.file);
      const Robot robot = test::require_robot(require_parts("robots/" + facts.file + ".urdf"));
      check_poses(robot, facts);
      CHECK_FALSE(robot.self_pairs().empty());
    }
  }

  TEST_CASE("the robots differ from their sources in shapes alone") {
    for (const Facts& facts : all_facts()) {
      CAPTURE(facts.file);
      Robot::Parts source = require_parts("robots/source/" + facts.file + ".urdf");
      Robot::Parts made = require_parts("robots/" + facts.file + ".urdf");
      source.allowed_pairs = made.allowed_pairs;
      for (Robot::Parts* parts : {&source, &made}) {
        for (Link& link : parts->links) link = Link{link.name, -1, {}, {}, {}};
      }
      CHECK(test::require_robot(source).hash() == test::require_robot(made).hash());
    }
  }
}

}  // namespace mneme
