// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/problem_input.h"
#include "problem/small_robots.h"
#include "scene/yaml.h"
#include "support/support.h"

namespace mneme::test {
namespace {

const std::string kRobotSource = "f";

using internal::Input;
using internal::ProblemRobot;

/// A directory with lifter.urdf, and what problem files in it say about the robot.
class Lifter {
 public:
  Lifter() { write_file(directory_ / "lifter.urdf", kLiftUrdf); }

  Result<ProblemRobot> read(const std::string& yaml, const ProblemOptions& options = {}) const {
    return internal::without_throwing([&] {
      const auto value = internal::parse_yaml(yaml, "f");
      return internal::read_robot(Input(value, kRobotSource), directory_ / ".", options);
    });
  }
  Result<ProblemRobot> read(const std::string& yaml, const std::string& override_path) const {
    ProblemOptions options;
    options.robot_path = override_path;
    return read(yaml, options);
  }
  Robot robot() const { return read("robot: lifter.urdf").value().robot; }
  std::string path() const { return directory_ / "lifter.urdf"; }

 private:
  TemporaryDirectory directory_;
};

template <class Check>
Result<Transform> apply(const std::string& yaml, Check&& check) {
  return internal::without_throwing([&] {
    const auto value = internal::parse_yaml(yaml, "f");
    return check(Input(value, kRobotSource));
  });
}

std::string facts(const std::string& yaml, const Robot& robot) {
  const auto result = apply(yaml, [&](const Input& input) {
    internal::check_robot_facts(input, robot);
    return Transform{};
  });
  return result ? "" : result.error().message;
}

TEST_SUITE("unit") {
  TEST_CASE("a robot is found by name, by relative path, or where the caller says") {
    const Lifter lifter;
    CHECK(lifter.read("robot: planar8").value().robot.joint_count() == 8);
    CHECK(lifter.read("robot: lifter.urdf").value().robot.name() == "lifter");
    CHECK(lifter.read("robot: ./lifter.urdf").value().robot.name() == "lifter");
    CHECK(lifter.read("robot: " + lifter.path()).value().robot.name() == "lifter");
    CHECK(lifter.read("robot: planar8", lifter.path()).value().path == lifter.path());
    CHECK(lifter.read("{}", lifter.path()).value().robot.name() == "lifter");
  }

  TEST_CASE("a robot that is missing is refused where it is named") {
    const Lifter lifter;
    CHECK(lifter.read("{}").error().message == "f:1: expected the key robot, which is missing");
    const auto unknown = lifter.read("robot: planar9");
    REQUIRE_FALSE(unknown.has_value());
    CHECK(unknown.error().message.find("f:1: key robot: ") == 0);
    CHECK(unknown.error().message.find("planar9") != std::string::npos);
    const auto lost = lifter.read("robot: ./lost.urdf");
    REQUIRE_FALSE(lost.has_value());
    CHECK(lost.error().code == ErrorCode::io);
    CHECK(lost.error().message.find("lost.urdf") != std::string::npos);
  }

  TEST_CASE("joints choose the group and its order, and fixed joints have their values") {
    const Lifter lifter;
    const auto read =
        lifter.read("robot: lifter.urdf\njoints: [turn, lift]\nfixed_joints: {grip: 0.03}");
    REQUIRE_MESSAGE(read.has_value(), (read ? "" : read.error().message));
    CHECK(read->robot.joint_count() == 2);
    CHECK(read->robot.group_joint(0).name == "turn");
    CHECK(read->robot.group_joint(1).name == "lift");
    for (const Joint& joint : read->robot.joints()) {
      if (joint.name == "grip") CHECK(joint.fixed_value == 0.03);
    }
    CHECK(read->warnings.empty());
  }

  TEST_CASE("values of joints that cannot be fixed are left aside with a warning") {
    const Lifter lifter;
    const auto read = lifter.read(
        "robot: lifter.urdf\njoints: [turn, lift]\nfixed_joints: {wheel: 0, mount: 1, lift: 0}");
    REQUIRE(read.has_value());
    REQUIRE(read->warnings.size() == 1);
    CHECK(read->warnings[0] ==
          "f:3: key fixed_joints: left aside for robot lifter: lift (planned for), mount (a "
          "fixed joint), wheel (no such joint)");
  }

  TEST_CASE("joints and fixed values of the caller stand for those of the file") {
    const Lifter lifter;
    ProblemOptions options;
    options.robot.joints = {"lift"};
    options.robot.fixed_values = {{"grip", 0.01}};
    const auto read = lifter.read(
        "robot: lifter.urdf\njoints: [turn, lift]\nfixed_joints: {grip: 0.03, turn: 1}", options);
    REQUIRE_MESSAGE(read.has_value(), (read ? "" : read.error().message));
    CHECK(read->robot.joint_count() == 1);
    for (const Joint& joint : read->robot.joints()) {
      if (joint.name == "grip") CHECK(joint.fixed_value == 0.01);
      if (joint.name == "turn") CHECK(joint.fixed_value == 1);
    }
    CHECK(read->warnings.empty());
  }

  TEST_CASE("a group of the caller gives way to the joints of the file with a warning") {
    const Lifter lifter;
    ProblemOptions options;
    options.robot.group = "arm";
    const auto read = lifter.read("robot: lifter.urdf\njoints: [turn, lift]", options);
    REQUIRE_MESSAGE(read.has_value(), (read ? "" : read.error().message));
    CHECK(read->robot.joint_count() == 2);
    REQUIRE(read->warnings.size() == 1);
    CHECK(read->warnings[0] ==
          "f:2: key joints: these joints are planned for, not those of group arm");
  }

  TEST_CASE("joints that are no texts and values that are no numbers are refused") {
    const Lifter lifter;
    CHECK(lifter.read("robot: lifter.urdf\njoints: [[turn]]").error().message ==
          "f:2: key joints[0]: expected a text, got a list of 1");
    CHECK(lifter.read("robot: lifter.urdf\njoints: [turn, spin]").error().message.find("spin") !=
          std::string::npos);
    CHECK(lifter.read("robot: lifter.urdf\nfixed_joints: {grip: wide}").error().message ==
          "f:2: key fixed_joints.grip: expected a number, got \"wide\"");
  }

  TEST_CASE("lengths of links must be those of the robot to within 1e-9") {
    const Robot robot = planar8();
    CHECK(facts("links: [1.6, 1.4, 1.8, 1.2, 1.5, 1.3, 1.1, 1.7000000001]", robot).empty());
    CHECK(facts("links: [1.6, 1.4, 1.8, 1.2, 1.5, 1.3, 1.1, 1.70000001]", robot)
              .find("f:1: key links: expected the lengths of robot planar8's capsules, [1.6, ") ==
          0);
    CHECK_FALSE(facts("links: [1.6, 1.4, 1.8, 1.2, 1.5, 1.3, 1.1]", robot).empty());
    CHECK_FALSE(facts("links: []", robot).empty());
  }

  TEST_CASE("joint limits must be those of the robot to within 1e-9") {
    const Robot robot = planar8();
    CHECK(facts("joint_limits: [-3.141592653589793, 3.141592653589793]", robot).empty());
    CHECK(facts("joint_limits: [-3.0, 3.0]", robot)
              .find("f:1: key joint_limits: expected the limits of robot planar8's joint joint_1, "
                    "[-3.1") == 0);
    CHECK(facts("joint_limits: [1]", robot) ==
          "f:1: key joint_limits: expected 2 numbers (lower and upper limit of all joints), got a "
          "list of 1");
  }

  TEST_CASE("a frame is the root link or one that is fixed to it") {
    const Lifter lifter;
    const Robot robot = lifter.robot();
    const auto frame = [&](const std::string& yaml) {
      return apply(yaml, [&](const Input& input) { return internal::read_frame(input, robot); });
    };
    CHECK(frame("{}").value().translation == Vec3::Zero());
    CHECK(frame("frame: world").value().rotation == Eigen::Matrix3d::Identity());
    const Transform X_WB = frame("frame: base").value();
    CHECK((X_WB * Vec3(1, 0, 0) - Vec3(0, 1, 0.5)).norm() < 1e-12);
    const auto unknown = frame("frame: table");
    REQUIRE_FALSE(unknown.has_value());
    CHECK(unknown.error().code == ErrorCode::invalid);
    CHECK(unknown.error().message ==
          "f:1: key frame: expected a link of robot lifter, got \"table\"");
    const auto moving = frame("frame: arm");
    REQUIRE_FALSE(moving.has_value());
    CHECK(moving.error().code == ErrorCode::unsupported);
    CHECK(moving.error().message ==
          "f:1: key frame: expected the root link of robot lifter or one fixed to it, got \"arm\", "
          "which joint turn moves");
  }
}

}  // namespace
}  // namespace mneme::test
