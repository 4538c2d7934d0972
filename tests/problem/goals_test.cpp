// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/moveit_files.h"
#include "problem/small_robots.h"
#include "input/input.h"
#include "support/support.h"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mneme::test {
namespace {

const std::string kStates = R"(<robot name="lifter">
  <group name="all"><joint name="lift"/><joint name="turn"/><joint name="grip"/></group>
  <group name="gripper"><joint name="grip"/></group>
  <group_state name="up" group="all">
    <joint name="lift" value="0.9"/><joint name="turn" value="1"/><joint name="grip" value="0.01"/>
  </group_state>
  <group_state name="open" group="gripper"><joint name="grip" value="0.05"/></group_state>
</robot>
)";

/// lifter.urdf with states, and problems in its directory.
class StatedLifter {
 public:
  StatedLifter() {
    write_file(directory_ / "lifter.urdf", kLiftUrdf);
    write_file(directory_ / "lifter.srdf", kStates);
  }
  [[nodiscard]] Result<Problem> load(const std::string& ends,
                                     const ProblemOptions& options = {}) const {
    write_file(directory_ / "p.yaml",
               "robot: lifter.urdf\ngroup: all\nframe: base\nscene: {obstacles: []}\n" + ends);
    return load_problem(directory_ / "p.yaml", options);
  }
  [[nodiscard]] Problem problem(const std::string& ends, const ProblemOptions& options = {}) const {
    return require(load(ends, options));
  }
  /// The message of the failure without the file's name.
  [[nodiscard]] std::string failure(const std::string& ends) const {
    const Error error = require_error(load(ends));
    const std::string& message = error.message;
    return message.substr(message.find("p.yaml") + 6);
  }
  [[nodiscard]] std::string path(const std::string& name) const { return directory_ / name; }

 private:
  TemporaryDirectory directory_;
};

const std::string kStart = "start: [0, 0, 0]\n";

TEST_SUITE("unit") {
  TEST_CASE("starts and goals are lists, maps of joints or named states") {
    const StatedLifter lifter;
    const Problem problem = lifter.problem(
        "start: {turn: 0.5, lift: 0.2, grip: 0}\ngoals: [up, [0.1, 0.2, 0.03], {lift: 0, turn: 1, "
        "grip: 0.05}]\n");
    CHECK(problem.start == Configuration{0.2, 0.5, 0});
    REQUIRE(problem.goals.size() == 3);
    CHECK(problem.goals[0] == Configuration{0.9, 1, 0.01});
    CHECK(problem.goals[1] == Configuration{0.1, 0.2, 0.03});
    CHECK(problem.goals[2] == Configuration{0, 1, 0.05});
    CHECK(problem.pose_goals.empty());
  }

  TEST_CASE("a pose of a link is in the frame of the scene, or in that of any link at the start") {
    const StatedLifter lifter;
    const std::string pose = "goal: {link: arm, position: [0, 0.3, 0.4], quat_xyzw: [0, 0, 1, 0]";
    const Problem in_base = lifter.problem(kStart + pose + "}\n");
    CHECK(in_base.goals.empty());
    REQUIRE(in_base.pose_goals.size() == 1);
    const PoseGoal& goal = in_base.pose_goals[0];
    CHECK(goal.link == "arm");
    // The base stands half a metre up, turned by a quarter.
    CHECK((goal.pose.translation - Vec3(-0.3, 0, 0.9)).norm() < 1e-9);
    CHECK(goal.position_tolerance == Vec3::Zero());
    CHECK(goal.cone == 0);
    CHECK(goal.turn == 0);
    const Problem in_arm = lifter.problem("start: [0.5, 0, 0]\n" + pose + ", frame: carriage}\n");
    CHECK((in_arm.pose_goals[0].pose.translation - Vec3(-0.3, 0, 1.4)).norm() < 1e-9);
  }

  TEST_CASE("tolerances make a region of it") {
    const StatedLifter lifter;
    const Problem problem = lifter.problem(
        kStart +
        "goals:\n"
        "  - {link: arm, position: [0, 0, 1]}\n"
        "  - {link: arm, position: [0, 0, 1], quat_xyzw: [0, 0, 0, 1], position_tolerance: 0.1,\n"
        "     axis: x, cone: 0.2, turn: free}\n"
        "  - {link: finger, position: [0, 0, 1], position_tolerance: [0, 0.1, 0.2]}\n");
    REQUIRE(problem.pose_goals.size() == 3);
    CHECK(problem.pose_goals[0].cone == std::numbers::pi);
    CHECK(problem.pose_goals[0].turn == std::numbers::pi);
    CHECK(problem.pose_goals[1].position_tolerance == Vec3::Constant(0.1));
    CHECK(problem.pose_goals[1].axis == Axis::x);
    CHECK(problem.pose_goals[1].cone == 0.2);
    CHECK(problem.pose_goals[1].turn == std::numbers::pi);
    CHECK(problem.pose_goals[2].position_tolerance == Vec3(0, 0.1, 0.2));
    // Written problems read back to the same.
    write_file(lifter.path("again.yaml"), to_yaml(problem, "lifter.urdf"));
    const auto again = require(load_problem(lifter.path("again.yaml")));
    REQUIRE(again.pose_goals.size() == 3);
    for (std::size_t i = 0; i < 3; ++i) {
      const PoseGoal &a = problem.pose_goals[i], &b = again.pose_goals[i];
      CHECK((a.pose.translation - b.pose.translation).norm() < 1e-9);
      CHECK((a.pose.rotation - b.pose.rotation).norm() < 1e-9);
      CHECK(a.position_tolerance == b.position_tolerance);
      CHECK(a.axis == b.axis);
      CHECK(a.cone == doctest::Approx(b.cone));
      CHECK(a.turn == doctest::Approx(b.turn));
    }
  }

  TEST_CASE("poses from outside replace the goals of the file, beside a goal from outside") {
    const StatedLifter lifter;
    ProblemOptions options;
    PoseGoal pose;
    pose.link = "arm";
    pose.pose.translation = Vec3(0, 0, 0.2);
    options.pose_goals = {pose};
    const std::string ends = kStart + "goal: [0.1, 0, 0]\n";
    const Problem replaced = lifter.problem(ends, options);
    CHECK(replaced.goals.empty());
    REQUIRE(replaced.pose_goals.size() == 1);
    CHECK((replaced.pose_goals[0].pose.translation - Vec3(0, 0, 0.7)).norm() < 1e-9);
    options.goal = Configuration{0.2, 0, 0};
    CHECK(lifter.problem(ends, options).goals == std::vector<Configuration>{{0.2, 0, 0}});
    CHECK(lifter.problem(ends, options).pose_goals.size() == 1);
  }

  TEST_CASE("named states may stand for the start and the goals of the file") {
    const StatedLifter lifter;
    ProblemOptions options;
    options.start = options.goal = GivenConfiguration("up");
    const Problem problem = lifter.problem(kStart + "goal: [0.1, 0, 0]\n", options);
    CHECK(problem.start == Configuration{0.9, 1, 0.01});
    CHECK(problem.goals == std::vector<Configuration>{{0.9, 1, 0.01}});
    options.goal = GivenConfiguration("down");
    const Error refused = require_error(lifter.load(kStart + "goal: [0.1, 0, 0]\n", options));
    const std::string& message = refused.message;
    CHECK_MESSAGE(message.starts_with("goal: expected a state that the SRDF"), message);
    CHECK_MESSAGE(contains(message, "got \"down\""), message);
  }

  TEST_CASE("goals that are none are refused where they stand") {
    const StatedLifter lifter;
    const auto failure = [&](const std::string& goal) {
      return lifter.failure(kStart + "goal: " + goal + "\n");
    };
    const auto pose = [&](const std::string& rest) {
      return failure("{link: arm, position: [0, 0, 1], " + rest + "}");
    };
    CHECK(failure("home") ==
          ":6: key goal: expected a state that the SRDF of robot lifter names "
          "(up, open), got \"home\"");
    CHECK(failure("open") ==
          ":6: key goal: state \"open\" of group gripper has no value for "
          "joint lift of the planning group");
    CHECK(failure("{lift: 0, turn: 0}") ==
          ":6: key goal: expected a value of each joint of the planning group, got none of grip");
    CHECK(failure("{lift: 0, spin: 0}") ==
          ":6: key goal.spin: expected a joint of the planning group (lift, turn, grip), got "
          "\"spin\"");
    for (const char* far : {"1e308", "20000", "-1e5"}) {
      CHECK(
          failure(fmt::format("{{link: arm, position: [{}, 0, 0]}}", far)) ==
          ":6: key goal: expected a pose of link \"arm\" within 10000 m of the root link's origin");
    }
    CHECK(pose("quat_xyzw: [0, 0, 0, 0]") ==
          ":6: key goal.quat_xyzw: expected a quaternion of length 1, got one of length 0");
    CHECK(pose("quat_xyzw: [0, 0, 0, 2]") ==
          ":6: key goal.quat_xyzw: expected a quaternion of length 1, got one of length 2");
    CHECK(pose("quat_xyzw: [0, 0, 0, .nan]").starts_with(":6: key goal.quat_xyzw"));
    CHECK(pose("frame: moon") ==
          ":6: key goal.frame: expected a link of robot lifter, got \"moon\"");
    CHECK(pose("position_tolerance: -0.1") ==
          ":6: key goal: the region is empty: expected position tolerances of 0 m or more, got "
          "-0.1, -0.1, -0.1");
    CHECK(pose("position_tolerance: []").starts_with(":6: key goal.position_tolerance: expected"));
    CHECK(
        pose("quat_xyzw: [0, 0, 0, 1], cone: -1") ==
        ":6: key goal: the region is empty: expected angles of 0 or more, got cone -1 and turn 0");
    CHECK(pose("cone: 1") == ":6: key goal.cone: expected the key quat_xyzw, too");
    CHECK(pose("axis: w") == ":6: key goal.axis: expected x, y or z, got \"w\"");
    CHECK(pose("quat: 1").starts_with(":6: key goal.quat: unknown key"));
    CHECK(
        failure("1").starts_with(":6: key goal: expected a list of values, a map from joints to "
                                 "values or the name of a state, got"));
    CHECK(failure("{link: nose, position: [0, 0, 1]}") ==
          ":6: key goal: expected a link of robot lifter, got \"nose\"");
    CHECK(failure("{link: arm, frame: '', position: [0, 0, 1]}")
              .starts_with(":6: key goal.frame: expected the name of a link"));
    CHECK(failure("{link: base, position: [0, 0, 1]}") ==
          ":6: key goal: no joint of the planning group moves link \"base\"");
    CHECK(failure("{link: arm, position: [0, 0, .nan]}").starts_with(":6: key goal.position"));
    CHECK(contains(
        lifter.failure("start: [0, 0]\ngoal: {link: arm, frame: arm, position: [0, 0, 1]}\n"),
        "there are 2 values"));
  }

  TEST_CASE("a pose in the frame of a link is where that link is") {
    const StatedLifter lifter;
    const Robot robot = lifter.problem(kStart + "goal: up\n").robot;
    const Configuration q = {0.2, 0.5, 0};
    PoseGoal goal;
    goal.link = "arm";
    goal.pose.translation = Vec3(0.1, 0.2, 0.3);
    CHECK(in_root_frame(goal, robot, q)->pose.translation == goal.pose.translation);
    goal.frame = "arm";
    CHECK(describe_fault(robot, goal) ==
          "expected a pose in the root link's frame, got one in that of link \"arm\"");
    CHECK(contains(to_json(goal), R"("frame":"arm")"));
    const auto placed = require(in_root_frame(goal, robot, q));
    CHECK(placed.frame.empty());
    const Transform X_RF = robot.link_poses(q)[static_cast<std::size_t>(*robot.find_link("arm"))];
    CHECK(placed.pose.translation.isApprox(X_RF * goal.pose.translation));
    CHECK(placed.pose.rotation.isApprox(X_RF.rotation));
    CHECK(contains(in_root_frame(goal, robot, Configuration{0}).error().message, "is unknown"));
    goal.frame = "nose";
    CHECK(in_root_frame(goal, robot, q).error().message ==
          "expected a link of robot lifter, got \"nose\"");
  }

  TEST_CASE("the error of a pose is what is beyond its region") {
    const StatedLifter lifter;
    const Robot robot = lifter.problem(kStart + "goal: up\n").robot;
    PoseGoal goal;
    goal.link = "arm";
    goal.pose.translation = Vec3(0, 0, 0.6);
    goal.pose.rotation = rotation_about(Vec3::UnitZ(), std::numbers::pi / 2);
    const auto error_at = [&](double lift, double turn) {
      return pose_error(robot, goal, Configuration{lift, turn, 0});
    };
    CHECK(error_at(0.1, 0).position < 1e-9);
    CHECK(error_at(0.1, 0).rotation < 1e-9);
    CHECK(error_at(0.3, 0.5).position == doctest::Approx(0.2));
    CHECK(error_at(0.3, 0.5).rotation == doctest::Approx(0.5));
    goal.position_tolerance = Vec3(0, 0, 0.15);
    goal.turn = 0.2;
    CHECK(error_at(0.3, 0.5).position == doctest::Approx(0.05));
    CHECK(error_at(0.3, 0.5).rotation == doctest::Approx(0.3));
    goal.axis = Axis::x;
    CHECK(error_at(0.3, 0.5).rotation == doctest::Approx(0.5));
    goal.cone = 0.4;
    CHECK(error_at(0.3, 0.5).rotation == doctest::Approx(0.1));
  }
}

const std::string kPoseRequest = R"(goal_constraints:
  - position_constraints:
      - link_name: arm
        header: {frame_id: base}
        target_point_offset: {x: 0, y: 0, z: 0}
        constraint_region:
          primitives: [{type: 1, dimensions: [0.2, 0.4, 0.6]}]
          primitive_poses: [{position: [0, 0, 0.3], orientation: [0, 0, 0, 1]}]
        weight: 1
    orientation_constraints:
      - link_name: arm
        header: {frame_id: base}
        orientation: {x: 0, y: 0, z: 0, w: 1}
        absolute_x_axis_tolerance: 0.1
        absolute_y_axis_tolerance: 0.2
        absolute_z_axis_tolerance: 3.2
        weight: 1
)";

std::string with(const std::string& from, const std::string& to) {
  std::string text = kPoseRequest;
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

PoseGoal oriented_goal(const Vec3& tolerance, bool is_vector) {
  std::string text = kPoseRequest.substr(0, kPoseRequest.find("        absolute_x_axis_tolerance"));
  for (int i = 0; i < 3; ++i) {
    text += fmt::format("        absolute_{}_axis_tolerance: {}\n", "xyz"[i], tolerance[i]);
  }
  if (is_vector) text += "        parameterization: 1\n";
  return require(MoveitFiles(kMoveitScene, text).load()).pose_goals.at(0);
}

/// Off the pose of the goal, as its cone and its turn let it be.
Eigen::Matrix3d random_rotation_within(const PoseGoal& goal, Rng& rng) {
  const int axis = static_cast<int>(goal.axis);
  const double towards = rng.uniform(-std::numbers::pi, std::numbers::pi);
  Vec3 lean = Vec3::Zero();
  lean[(axis + 1) % 3] = std::cos(towards);
  lean[(axis + 2) % 3] = std::sin(towards);
  return rotation_about(lean, goal.cone * std::sqrt(rng.uniform(0, 1))) *
         rotation_about(Vec3::Unit(axis), rng.uniform(-goal.turn, goal.turn));
}

/// About x, then the new y, then the new z.
Vec3 euler_angles(const Eigen::Matrix3d& m) {
  return {std::atan2(-m(1, 2), m(2, 2)), std::asin(std::clamp(m(0, 2), -1.0, 1.0)),
          std::atan2(-m(0, 1), m(0, 0))};
}

Vec3 rotation_vector(const Eigen::Matrix3d& m) {
  const Eigen::AngleAxisd turn(m);
  return turn.angle() * turn.axis();
}

TEST_SUITE("unit") {
  TEST_CASE("MoveIt's position and orientation constraints are a pose with tolerances") {
    const MoveitFiles files(kMoveitScene, kPoseRequest);
    const auto problem = require(files.load());
    CHECK(problem.goals.empty());
    REQUIRE(problem.pose_goals.size() == 1);
    const PoseGoal& goal = problem.pose_goals[0];
    CHECK(goal.link == "arm");
    CHECK((goal.pose.translation - Vec3(0, 0, 0.8)).norm() < 1e-9);
    CHECK((goal.position_tolerance - Vec3(0.1, 0.2, 0.3)).norm() < 1e-9);
    CHECK(goal.axis == Axis::z);
    CHECK(goal.cone == doctest::Approx(0.1));
    CHECK(goal.turn == doctest::Approx(std::numbers::pi));
  }

  TEST_CASE("of MoveIt's regions the largest that fits within them is taken") {
    const auto sphere =
        require(MoveitFiles(kMoveitScene, with("type: 1, dimensions: [0.2, 0.4, 0.6]",
                                               "type: sphere, dimensions: [0.3]"))
                    .load());
    CHECK(sphere.pose_goals[0].position_tolerance.norm() == doctest::Approx(0.3));
    const auto narrow =
        MoveitFiles(kMoveitScene, with("axis_tolerance: 3.2", "axis_tolerance: 0.5")).load();
    REQUIRE_MESSAGE(narrow.has_value(), (narrow ? "" : narrow.error().message));
    CHECK(narrow->pose_goals[0].turn == doctest::Approx(0.495));
  }

  TEST_CASE("rotations in the region are within MoveIt's tolerances, whichever axis is freest") {
    Rng rng(17);
    const Vec3 tolerances[] = {{0.1, 0.1, 3.2}, {0.1, 3.2, 0.1}, {3.2, 0.1, 0.1}, {0.1, 1.4, 0.1},
                               {0.1, 1, 0.1},   {0.5, 0.6, 0.5}, {1, 1.2, 1},     {0.3, 1.2, 0.5},
                               {1, 1, 1},       {2, 3.2, 3},     {0, 3.2, 0}};
    for (const Vec3& tolerance : tolerances) {
      for (const bool is_vector : {false, true}) {
        const PoseGoal goal = oriented_goal(tolerance, is_vector);
        CHECK(goal.turn > 0);
        CHECK((goal.cone > 0) == (tolerance.minCoeff() > 0));
        INFO("tolerances " << tolerance.transpose() << (is_vector ? ", rotation vector" : ""));
        for (int i = 0; i < 3000; ++i) {
          const Eigen::Matrix3d off = random_rotation_within(goal, rng);
          const Vec3 angles = is_vector ? rotation_vector(off) : euler_angles(off);
          REQUIRE(
              (angles.cwiseAbs().array() <= tolerance.array().min(std::numbers::pi) + 1e-6).all());
        }
      }
    }
  }

  TEST_CASE("MoveIt's goals that are no single pose are refused by name") {
    const auto failure = [](const std::string& from, const std::string& to) {
      return MoveitFiles(kMoveitScene, with(from, to)).failure();
    };
    CHECK(failure("type: 1, dimensions: [0.2, 0.4, 0.6]", "type: 3, dimensions: [1, 1]")
              .ends_with("expected a box or a sphere as the region of a position"));
    CHECK(failure("{x: 0, y: 0, z: 0}", "{x: 0, y: 0, z: 0.1}")
              .ends_with(
                  "expected no target_point_offset, because the region is for the link's origin"));
    CHECK(contains(failure("frame_id: base", "frame_id: moon"), "got \"moon\""));
    CHECK(failure("link_name: arm", "link_name: finger")
              .ends_with("expected the link of the orientation constraint, arm, got finger"));
    CHECK(contains(failure("z: 0, w: 1}", "z: 0, w: 0}"), "orientation"));
    CHECK(contains(failure("axis_tolerance: 0.1", "axis_tolerance: -0.1"),
                   "expected a tolerance of 0 or more"));
    CHECK(failure("    orientation_constraints:",
                  "    joint_constraints: [{joint_name: turn, position: 1}]\n    "
                  "orientation_constraints:")
              .ends_with("joint_constraints are not supported; expected joint_constraints alone, "
                         "or constraints of position and orientation"));
  }
}

}  // namespace
}  // namespace mneme::test
