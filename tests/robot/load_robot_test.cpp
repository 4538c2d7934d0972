// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// The robots that come with mneme, against facts about their kinematics (see robots/SOURCE.md).
#include "robot/small_robots.h"
#include "support/environment.h"
#include "support/support.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <regex>
#include <string>
#include <vector>

namespace mneme {
namespace {

using test::contains;
using test::require;
using test::require_error;

const std::string kUrdf = R"(<robot name="arm">
  <link name="base"/><link name="upper"/><link name="tool"/>
  <joint name="lift" type="prismatic"><parent link="base"/><child link="upper"/>
    <limit lower="0" upper="1"/></joint>
  <joint name="turn" type="continuous"><parent link="upper"/><child link="tool"/></joint>
</robot>
)";

std::string srdf_for(const std::string& joint) {
  return "<robot name=\"arm\"><group name=\"g\"><joint name=\"" + joint + "\"/></group></robot>";
}

RobotOptions with_srdf(const std::string& path) {
  RobotOptions options;
  options.srdf_path = path;
  return options;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a file and its text give the same robot") {
    const test::TemporaryDirectory directory;
    test::write_file(directory / "arm.urdf", kUrdf);
    CHECK(load_robot(directory / "arm.urdf").value().hash() ==
          parse_robot(kUrdf, "text").value().hash());
  }

  TEST_CASE("a quaternion whose length is not 1 is scaled with a warning, or refused") {
    const auto turned_by = [](const std::string& quaternion) {
      std::string urdf = kUrdf;
      const std::string place = "<child link=\"tool\"/>";
      return urdf.insert(urdf.find(place), "<origin quat_xyzw=\"" + quaternion + "\"/>");
    };
    const auto twice = require(parse_robot(turned_by("0 0 1 1"), "text"));
    const Eigen::Matrix3d quarter =
        Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitZ()).toRotationMatrix();
    CHECK(twice.joints().back().origin.rotation.isApprox(quarter));
    REQUIRE(twice.warnings().size() == 1);
    CHECK(contains(twice.warnings()[0], "<origin>: the quaternion's length is not 1"));
    for (const char* wrong : {"0 0 0 0", "0 0 0 20", "0 0 0 0.01"}) {
      CHECK(contains(parse_robot(turned_by(wrong), "text").error().message,
                     std::string("quat_xyzw is ") + wrong + ", expected a quaternion of length 1"));
    }
  }

  TEST_CASE("the SRDF beside a URDF counts, unless the options name another") {
    const test::TemporaryDirectory directory;
    test::write_file(directory / "arm.urdf", kUrdf);
    test::write_file(directory / "arm.srdf", srdf_for("turn"));
    test::write_file(directory / "other.srdf", srdf_for("lift"));
    CHECK(load_robot(directory / "arm.urdf").value().group_joint(0).name == "turn");
    CHECK(load_robot(directory / "arm.urdf", with_srdf(directory / "other.srdf"))
              .value()
              .group_joint(0)
              .name == "lift");
    CHECK(parse_robot(kUrdf, directory / "arm.urdf").value().joint_count() == 2);
  }

  TEST_CASE("a robot's parts can be made into the robot that is loaded") {
    const test::TemporaryDirectory directory;
    test::write_file(directory / "arm.urdf", kUrdf);
    test::write_file(directory / "arm.srdf", srdf_for("turn"));
    const auto parts = require(read_robot(directory / "arm.urdf"));
    CHECK(parts.groups.size() == 1);
    CHECK(make_robot(parts).value().hash() == load_robot(directory / "arm.urdf").value().hash());
  }

  TEST_CASE("files that cannot be read or are too long are errors that name the file") {
    const test::TemporaryDirectory directory;
    const std::string absent = directory / "absent.urdf";
    CHECK(load_robot(absent).error().code == ErrorCode::io);
    CHECK(contains(load_robot(absent).error().message, absent + ": cannot be read: No such file"));
    const std::string large = directory / "large.urdf";
    test::write_file(large, kUrdf);
    std::filesystem::resize_file(large, (std::uintmax_t{64} << 20) + 1);
    CHECK(contains(load_robot(large).error().message,
                   large + ": expected a file of at most 67108864 bytes"));
    const auto no_srdf = parse_robot(kUrdf, "arm.urdf", with_srdf(directory / "no.srdf"));
    CHECK(no_srdf.error().code == ErrorCode::io);
    CHECK(contains(no_srdf.error().message, "no.srdf: cannot be read"));
  }

  TEST_CASE("a mesh of an unknown package may lie above the URDF, unless reading is strict") {
    const test::TemporaryDirectory files;
    std::filesystem::create_directories(files / "meshes");
    test::write_file(files / "meshes/a.stl", "a mesh");
    const std::string urdf = files / "arm.urdf";
    test::write_file(urdf, R"(<robot name="r"><link name="l"><collision><geometry>
      <mesh filename="package://old_name/meshes/a.stl"/></geometry></collision></link>
      <link name="m"/><joint name="j" type="revolute"><parent link="l"/><child link="m"/>
      <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>)");
    const auto parts = require(read_robot(urdf));
    CHECK(std::filesystem::equivalent(std::get<MeshFile>(parts.links[0].solids[0]).path,
                                      files / "meshes/a.stl"));
    CHECK(contains(read_robot(urdf, {.strict = true}).error().message,
                   "there is no package 'old_name'"));
  }

  TEST_CASE("options that do not fit the robot are errors that name the file") {
    const Error error = require_error(parse_robot(kUrdf, "arm.urdf", test::plan_for({"elbow"})));
    CHECK(error.code == ErrorCode::invalid);
    CHECK(error.message.starts_with("arm.urdf: robot 'arm': there is no joint 'elbow'"));
  }
}

namespace {

/// Sets MNEME_ROBOT_PATH for one scope.
struct RobotPath : test::EnvironmentVariable {
  explicit RobotPath(const std::string& value) : EnvironmentVariable("MNEME_ROBOT_PATH", value) {}
};

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("robots that came with mneme are found by name, with or without extension") {
    const RobotPath nothing("");
    for (const char* name : {"planar8", "planar8.urdf"}) {
      CHECK(load_robot(require(find_robot(name))).has_value());
    }
  }

  TEST_CASE("the directories of MNEME_ROBOT_PATH come first, in their order") {
    const test::TemporaryDirectory first, second;
    test::write_file(second / "planar8.urdf", "");
    const RobotPath path(first / "" + "::" + second / "");
    CHECK(std::filesystem::equivalent(find_robot("planar8").value(), second / "planar8.urdf"));
    test::write_file(first / "planar8.urdf", "");
    CHECK(std::filesystem::equivalent(find_robot("planar8").value(), first / "planar8.urdf"));
  }

  TEST_CASE("an unknown robot is an error that names the directories and what is there") {
    const RobotPath path("/nowhere");
    const Error error = require_error(find_robot("no_such_robot"));
    CHECK(error.code == ErrorCode::io);
    CHECK(test::contains(error.message, "'no_such_robot'"));
    CHECK(test::contains(error.message, "/nowhere, "));
    CHECK(test::contains(error.message, "robots (which has fetch, panda, planar8, ur5)"));
  }

  TEST_CASE("a file that is called as an unknown robot is said") {
    const test::TemporaryDirectory here;
    const std::filesystem::path before = std::filesystem::current_path();
    std::filesystem::current_path(here / "");
    test::write_file(here / "arm.urdf", "");
    const auto found = find_robot("arm");
    std::filesystem::current_path(before);
    CHECK(require_error(found).message.ends_with("; the file here is ./arm.urdf"));
  }

  TEST_CASE("a path is no name") {
    CHECK(find_robot("../robots/planar8").error().code == ErrorCode::invalid);
    CHECK(find_robot("").error().code == ErrorCode::invalid);
  }
}

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
  auto parts = require(read_robot(test::source_file(file)));
  CHECK(parts.warnings.empty());
  return parts;
}

/// Without shapes, whose meshes are not part of mneme.
Robot::Parts require_bare_source(const std::string& name) {
  const std::string path = test::source_file("robots/source/" + name + ".urdf");
  std::ifstream file(path);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  text = std::regex_replace(text, std::regex("<collision>.*</collision>"), "");
  return require(parse_robot_parts(text, path));
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
      check_poses(test::require_robot(require_bare_source(facts.file), {.joints = facts.joints}),
                  facts);
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
      Robot::Parts source = require_bare_source(facts.file);
      Robot::Parts made = require_parts("robots/" + facts.file + ".urdf");
      source.allowed_pairs = made.allowed_pairs;
      source.groups = made.groups;
      for (Robot::Parts* parts : {&source, &made}) {
        for (Link& link : parts->links) link = Link{.name = link.name};
      }
      CHECK(test::require_robot(source).hash() == test::require_robot(made).hash());
    }
  }
}

}  // namespace mneme
