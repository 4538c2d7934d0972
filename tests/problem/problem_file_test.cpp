// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/problem.h"

#include "problem/moveit_files.h"
#include "problem/problem_input.h"
#include "problem/small_robots.h"
#include "input/input.h"
#include "support/support.h"

#include <limits>

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
    const Error error = require_error(lifter.read("robot: planar9"));
    CHECK(error.message.find("f:1: key robot: ") == 0);
    CHECK(contains(error.message, "planar9"));
    const Error lost = require_error(lifter.read("robot: ./lost.urdf"));
    CHECK(lost.code == ErrorCode::io);
    CHECK(lost.message.find("f:1: key robot: ") == 0);
    CHECK(contains(lost.message, "lost.urdf: cannot be read"));
    const Error groups = require_error(lifter.read("robot: lifter.urdf\nsrdf: lost.srdf"));
    CHECK(groups.message.find("f:2: key srdf: ") == 0);
    CHECK(contains(groups.message, "lost.srdf: cannot be read"));
  }

  TEST_CASE("a robot of the caller's that is missing is not looked for in the problem") {
    const Lifter lifter;
    CHECK(require_error(lifter.read("robot: lifter.urdf", "none.urdf"))
              .message.find("none.urdf: cannot be read") == 0);
    ProblemOptions options;
    options.robot.srdf_path = "none.srdf";
    const Error error = require_error(lifter.read("robot: lifter.urdf\nsrdf: lost.srdf", options));
    CHECK(error.message.find("none.srdf: cannot be read") == 0);
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
    const auto read = require(lifter.read(
        "robot: lifter.urdf\njoints: [turn, lift]\nfixed_joints: {wheel: 0, mount: 1, lift: 0}"));
    REQUIRE(read.warnings.size() == 1);
    CHECK(read.warnings[0] ==
          "f:3: key fixed_joints: ignored for robot lifter: lift (planned for), mount (a "
          "fixed joint), wheel (no such joint)");
  }

  TEST_CASE("a fixed joint that the robot lacks gets the name that may be meant") {
    const Lifter lifter;
    const auto read = require(
        lifter.read("robot: lifter.urdf\njoints: [turn, lift]\nfixed_joints: {gripp: 0.03}"));
    REQUIRE(read.warnings.size() == 1);
    CHECK(read.warnings[0].ends_with("gripp (no such joint; did you mean 'grip'?)"));
  }

  TEST_CASE("of many values that are left aside the first are named") {
    const Lifter lifter;
    const auto read = require(lifter.read(
        "robot: lifter.urdf\njoints: [turn, lift]\nfixed_joints: {a: 0, b: 0, c: 0, d: 0, e: 0}"));
    REQUIRE(read.warnings.size() == 1);
    CHECK(read.warnings[0].ends_with("b (no such joint), c (no such joint), and 2 more"));
  }

  TEST_CASE("joints and fixed values of the caller stand for those of the file") {
    const Lifter lifter;
    ProblemOptions options;
    options.robot.joints = {"lift"};
    options.robot.fixed_values = {{"grip", 0.01}};
    const auto read = require(lifter.read(
        "robot: lifter.urdf\njoints: [turn, lift]\nfixed_joints: {grip: 0.03, turn: 1}", options));
    CHECK(read.robot.joint_count() == 1);
    for (const Joint& joint : read.robot.joints()) {
      if (joint.name == "grip") CHECK(joint.fixed_value == 0.01);
      if (joint.name == "turn") CHECK(joint.fixed_value == 1);
    }
    CHECK(read.warnings.empty());
  }

  TEST_CASE("a group of the caller gives way to the joints of the file with a warning") {
    const Lifter lifter;
    ProblemOptions options;
    options.robot.group = "arm";
    const auto read = require(lifter.read("robot: lifter.urdf\njoints: [turn, lift]", options));
    CHECK(read.robot.joint_count() == 2);
    REQUIRE(read.warnings.size() == 1);
    CHECK(read.warnings[0] ==
          "f:2: key joints: planning is for these joints; group arm is ignored");
    const auto both = require(lifter.read("robot: lifter.urdf\njoints: [turn, lift]\ngroup: arm"));
    CHECK(both.warnings == read.warnings);
  }

  TEST_CASE("joints that are no texts and values that are no numbers are refused") {
    const Lifter lifter;
    CHECK(lifter.read("robot: lifter.urdf\njoints: [[turn]]").error().message ==
          "f:2: key joints[0]: expected a text, got a list of 1");
    CHECK(
        contains(lifter.read("robot: lifter.urdf\njoints: [turn, spin]").error().message, "spin"));
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
    const Error error = require_error(frame("frame: table"));
    CHECK(error.code == ErrorCode::invalid);
    CHECK(error.message ==
          "f:1: key frame: expected a link of robot lifter as frame, got \"table\"");
    const Error moving = require_error(frame("frame: arm"));
    CHECK(moving.code == ErrorCode::unsupported);
    CHECK(moving.message ==
          "f:1: key frame: expected the root link of robot lifter or one fixed to it, got \"arm\", "
          "which joint turn moves");
  }
}

const std::string kInputSource = "f";

Result<Problem> read_problem_text(const std::string& yaml, const ProblemOptions& options = {}) {
  return internal::without_throwing([&] {
    const auto value = internal::parse_yaml("robot: planar8\n" + yaml, "f");
    const Input input(value, kInputSource);
    return internal::read_problem({input, input, "p", "", {make_circle_scene("s", {{3, 4, 1}})}},
                                  options);
  });
}

TEST_SUITE("unit") {
  TEST_CASE("one goal or several are read") {
    CHECK(read_problem_text("start: [1]\ngoal: [2]").value().goals ==
          std::vector<Configuration>{{2}});
    CHECK(read_problem_text("start: [1]\ngoals: [[2], [3]]").value().goals ==
          std::vector<Configuration>{{2}, {3}});
  }

  TEST_CASE("start and goal of the options stand for those of the file") {
    ProblemOptions options;
    options.start = Configuration{5};
    options.goal = Configuration{6};
    const auto problem = require(read_problem_text("goals: [[2], [3]]", options));
    CHECK(problem.start == Configuration{5});
    CHECK(problem.goals == std::vector<Configuration>{{6}});
  }

  TEST_CASE("counts, limits and NaN of start and goal are left to planning") {
    CHECK(std::isnan(require(read_problem_text("start: [1, .nan]\ngoal: [99]")).start[1]));
  }

  TEST_CASE("starts and goals that are missing or no numbers are refused") {
    CHECK(read_problem_text("goal: [1]").error().message ==
          "f:1: expected the key start, which is missing");
    CHECK(read_problem_text("start: [1]").error().message ==
          "f:1: expected the key goal, which is missing");
    CHECK(read_problem_text("start: [1, x]\ngoal: [1]").error().message ==
          "f:2: key start[1]: expected a number, got \"x\"");
    CHECK(read_problem_text("start: 1\ngoal: [1]").error().message ==
          "f:2: key start: expected a list of values, a map from joints to values or the name of a "
          "state, got 1");
    CHECK(read_problem_text("start: [1]\ngoal: [[1]]").error().message ==
          "f:3: key goal[0]: expected a number, got a list of 1");
    CHECK(read_problem_text("start: [1]\ngoals: []").error().message ==
          "f:3: key goals: expected at least one goal, got a list of 0");
    CHECK(read_problem_text("start: [1]\ngoal: [1]\ngoals: [[1]]").error().message ==
          "f:4: key goals: expected either goal or goals, got both");
  }

  TEST_CASE("obstacles are moved from the frame to the root link") {
    const TemporaryDirectory directory;
    write_file(directory / "lifter.urdf", kLiftUrdf);
    ProblemOptions options;
    options.robot_path = directory / "lifter.urdf";
    const auto problem =
        read_problem_text("frame: base\nstart: [0, 0, 0]\ngoal: [0, 0, 0]", options);
    REQUIRE_MESSAGE(problem.has_value(), (problem ? "" : problem.error().message));
    CHECK(problem->robot_path == options.robot_path);
    const auto sphere = std::get<Sphere>(problem->scene.obstacles[0].shapes[0]);
    CHECK((sphere.center - Vec3(-4, 3, 0.5)).norm() < 1e-12);
  }

  TEST_CASE("a problem says which files it was read from") {
    const TemporaryDirectory directory;
    write_file(directory / "lifter.urdf", kLiftUrdf);
    write_file(directory / "lifter.json", "<robot name='lifter'/>");
    write_file(directory / "scene.json", "{circles: {a: [5, 5, 1]}}");
    const std::string ends = "start: [0, 0, 0]\ngoal: [0, 0, 0]\n", path = directory / "p.yaml";
    write_file(path, "robot: lifter.urdf\nsrdf: lifter.json\nscene: scene.json\n" + ends);
    const auto problem = require(load_problem(path));
    const std::vector<std::string> files = {path, directory / "scene.json",
                                            directory / "lifter.urdf", directory / "lifter.json"};
    CHECK(problem.files == files);
    CHECK(extract_scene(path)->files == std::vector(files.begin(), files.begin() + 2));
    const std::string compact = directory / "many.json";
    write_file(compact, to_compact_json(problem, directory / "lifter.urdf"));
    const auto again = require(load_problem(compact + "#p"));
    CHECK(again.files == std::vector{compact, directory / "lifter.urdf"});
  }

  TEST_CASE("objects of a scene file stand in the frame that it names") {
    const TemporaryDirectory directory;
    write_file(directory / "lifter.urdf", kLiftUrdf);
    const auto load = [&](const std::string& frame, const std::string& own) {
      write_file(directory / "scene.yaml",
                 "world: {collision_objects: [{header: {frame_id: " + frame +
                     "}, id: ball, operation: 0, primitives: [{type: 2, dimensions: [0.1]}], "
                     "primitive_poses: [{position: {x: 1, y: 0, z: 0}, orientation: {x: 0, y: 0, "
                     "z: 0, w: 1}}]}]}\n");
      write_file(directory / "p.yaml", "robot: lifter.urdf\ngroup: world:arm\n" + own +
                                           "scene: scene.yaml\nstart: [0, 0]\ngoal: [0, 1]\n");
      return load_problem(directory / "p.yaml").map([](const Problem& problem) {
        return std::get<Sphere>(problem.scene.obstacles.at(0).shapes.at(0)).center;
      });
    };
    CHECK((require(load("base", "")) - Vec3(0, 1, 0.5)).norm() < 1e-9);
    CHECK((require(load("world", "")) - Vec3(1, 0, 0)).norm() < 1e-9);
    CHECK((require(load("nowhere", "frame: base\n")) - Vec3(0, 1, 0.5)).norm() < 1e-9);
    CHECK(contains(require_error(load("nowhere", "")).message,
                   "its objects are in frame \"nowhere\", which is no link of robot lifter; name "
                   "the link that they are in under the key frame"));
  }

  TEST_CASE("a robot that is there already is taken instead of the one that the file names") {
    const TemporaryDirectory directory;
    const std::string path = directory / "p.yaml";
    const std::string text =
        "robot: nowhere.urdf\nscene: {circles: {a: [90, 5, 1]}}\n"
        "start: [0, 0, 0, 0, 0, 0, 0, 0]\ngoal: [0, 1, 0, 0, 0, 0, 0, 0]\n";
    write_file(path, text);
    ProblemOptions options;
    options.made_robot = planar8();
    const auto problem = require(load_problem(path, options));
    CHECK(problem.robot.links().data() == options.made_robot->links().data());
    write_file(path, text + "allow: [[link_1, link_3]]\n");
    CHECK(contains(require_error(load_problem(path, options)).message, "the robot is given"));
  }

  TEST_CASE("an obstacle far out of reach is a warning that names the unit") {
    const TemporaryDirectory directory;
    write_file(directory / "p.yaml",
               "robot: planar8\nstart: [0, 0, 0, 0, 0, 0, 0, 0]\ngoal: [1, 0, 0, 0, 0, 0, 0, 0]\n"
               "scene: {obstacles: [{name: near, type: sphere, position: [20, 0, 0], radius: 1}, "
               "{name: far, type: sphere, position: [800, 0, 0], radius: 1}]}\n");
    const auto problem = require(load_problem(directory / "p.yaml"));
    REQUIRE(problem.warnings.size() == 1);
    CHECK(problem.warnings[0] ==
          "obstacle far is 799 m away, and robot planar8 reaches 12 m: numbers in a scene are "
          "metres");
  }

  TEST_CASE("many obstacles far out of reach are one warning, long ones by where they are") {
    const TemporaryDirectory directory;
    write_file(directory / "p.yaml",
               "robot: planar8\nstart: [0, 0, 0, 0, 0, 0, 0, 0]\ngoal: [1, 0, 0, 0, 0, 0, 0, 0]\n"
               "scene: {obstacles: [{name: floor, type: box, position: [0, 0, -100], size: [900, "
               "900, 199]}, {name: table, type: box, position: [600, 0, 100], size: [600, 1200, "
               "200]}, {name: far, type: sphere, position: [800, 0, 0], radius: 1}]}\n");
    const auto problem = require(load_problem(directory / "p.yaml"));
    REQUIRE(problem.warnings.size() == 1);
    CHECK(problem.warnings[0] ==
          "obstacle table and 1 more are at least 300 m away, and robot planar8 reaches 12 m: "
          "numbers in a scene are metres");
  }

  TEST_CASE("a robot that nothing can touch is a warning") {
    const TemporaryDirectory directory;
    const auto warnings_of = [&](const std::string& base, const std::string& arm) {
      write_file(directory / "r.urdf",
                 "<robot name='r'><link name='base'>" + base + "</link><link name='arm'>" + arm +
                     "</link><joint name='j' type='continuous'><parent link='base'/>"
                     "<child link='arm'/><axis xyz='0 0 1'/></joint></robot>");
      write_file(directory / "p.yaml", "robot: ./r.urdf\nstart: [0]\ngoal: [1]\nscene: {}\n");
      return require(load_problem(directory / "p.yaml")).warnings;
    };
    const std::string ball = "<geometry><sphere radius='0.1'/></geometry>";
    const std::string seen = "<visual>" + ball + "</visual>";
    const std::string touched = "<collision>" + ball + "</collision>";
    CHECK(warnings_of(touched, touched).empty());
    for (const std::string& base : {seen, touched}) {
      const std::vector<std::string> warnings = warnings_of(base, seen);
      REQUIRE(warnings.size() == 1);
      CHECK(warnings[0] ==
            "no link that the group of robot r moves has collision geometry, so that no contact "
            "is found; expected <collision> elements in its URDF");
    }
  }

  TEST_CASE("paths are relative to the directory of the file") {
    CHECK(internal::directory_of("a/b.yaml") == "a");
    CHECK(internal::directory_of("b.yaml").empty());
  }
}

TEST_SUITE("unit") {
  TEST_CASE("the scene may stand in the problem's file or in one of its own") {
    const TemporaryDirectory directory;
    const std::string rest = "robot: planar8\nstart: [0]\ngoal: [0]\n";
    write_file(directory / "scene.yaml", "circles: {a: [1, 2, 3]}\n");
    write_file(directory / "inside.yaml", rest + "scene: {circles: {a: [1, 2, 3]}}\n");
    write_file(directory / "beside.yaml", rest + "scene: scene.yaml\nname: other\n");
    const auto inside = require(load_problem(directory / "inside.yaml"));
    CHECK(inside.name == "inside");
    CHECK(inside.scene.name == "inside");
    CHECK(inside.scene.obstacles.at(0).name == "a");
    const auto beside = require(load_problem(directory / "beside.yaml"));
    CHECK(beside.name == "other");
    CHECK(beside.scene.name == "scene");
    CHECK(beside.scene.obstacles.at(0).name == "a");
  }

  TEST_CASE("errors name the file that they are in") {
    const TemporaryDirectory directory;
    const std::string rest = "robot: planar8\nstart: [0]\ngoal: [0]\n";
    const auto failure = [&](const std::string& text) {
      write_file(directory / "p.yaml", text);
      return require_error(load_problem(directory / "p.yaml"))
          .message.substr((directory / "").size());
    };
    write_file(directory / "bad.yaml", "\ncircles: {a: [1, 2]}\n");
    CHECK(
        failure(rest + "scene: bad.yaml") ==
        "bad.yaml:2: key circles.a: expected 3 numbers (x, y, radius in metres), got a list of 2");
    CHECK(failure(rest + "scene: {circles: {a: [1, 2]}}") ==
          "p.yaml:4: key scene.circles.a: expected 3 numbers (x, y, radius in metres), got a list "
          "of 2");
    CHECK(failure(rest + "scene: lost.yaml") ==
          "p.yaml:4: key scene: " + (directory / "lost.yaml") +
              ": cannot be read: No such file or directory");
    CHECK(failure(rest + "scene: [a]") ==
          "p.yaml:4: key scene: expected a scene, or the path of a scene file, got a list of 1");
    CHECK(failure(rest) == "p.yaml:1: expected the key scene, which is missing");
    CHECK(failure(rest + "scene: {}\nplanner: rrt") ==
          "p.yaml:5: key planner: unknown key, expected one of name, robot, srdf, group, joints, "
          "fixed_joints, frame, scene, start, start_velocity, end_velocity, goal, goals, allow, "
          "attached, constraints, self_filter, region");
    CHECK(failure("circles: {a: [1, 2, 1]}") ==
          "p.yaml:1: this is a scene; expected a problem with robot, scene, start and "
          "goal");
    CHECK(
        failure(rest + "circles: {a: [1, 2, 1]}") ==
        "p.yaml:4: key circles: expected it in the problem's scene, as in `scene: {circles: ..}`");
    CHECK(failure("") == "p.yaml:1: expected a map, got nothing");
  }

  TEST_CASE("a file that is missing is an io error") {
    CHECK(load_problem("/nonexistent.yaml").error().code == ErrorCode::io);
    CHECK(load_problem("").error().code == ErrorCode::io);
  }
}

TEST_SUITE("flow") {
  TEST_CASE("the planar problems that come with mneme load, with starts and goals within limits") {
    int count = 0;
    for (const auto& file : std::filesystem::directory_iterator(source_file("scenes/planar"))) {
      if (file.path().extension() != ".yaml" || file.path().stem() == "grid") continue;
      const auto problem = require(load_problem(file.path().string()));
      CHECK(problem.name == file.path().stem());
      CHECK_FALSE(problem.robot.describe_violation(problem.start, "start"));
      CHECK_FALSE(problem.robot.describe_violation(problem.goals.at(0), "goal"));
      CHECK(problem.scene.obstacles.size() >= 2);
      ++count;
    }
    CHECK(count >= 6);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("the scene of every kind of file is read without its robot") {
    const MoveitFiles files;
    const auto check = [](const std::string& where, const std::string& name,
                          const std::string& frame) {
      const auto scene = require(extract_scene(where));
      CHECK(scene.scene.obstacles.at(0).name == name);
      CHECK(scene.frame == frame);
    };
    check(files / "request0001.yaml", "ball", "base");
    check(files / "scene0001.yaml", "ball", "base");
    check(files / "scene0001.yaml" + "," + files / "request0001.yaml", "ball", "base");
    write_file(files / "scene.yaml", "circles: {a: [1, 2, 3]}\n");
    check(files / "scene.yaml", "a", "");
    write_file(files / "p.yaml", "robot: nobody\nframe: hand\nscene: scene.yaml\n");
    check(files / "p.yaml", "a", "hand");
    write_file(files / "p.json", R"({"frame": "hand", "problems": [{"circles": [[1, 2, 3]]}]})");
    check(files / "p.json#1", "circle_1", "hand");
  }

  TEST_CASE("a scene is moved from its frame to the root link") {
    const Robot robot = parse_robot(kLiftUrdf, "lifter.urdf").value();
    const Scene scene = make_circle_scene("s", {{3, 4, 1}});
    const auto center = [](const Result<Scene>& moved) {
      return std::get<Sphere>(moved.value().obstacles.at(0).shapes.at(0)).center;
    };
    CHECK(center(in_root_frame({scene, ""}, robot)) == Vec3(3, 4, 0));
    CHECK((center(in_root_frame({scene, "base"}, robot)) - Vec3(-4, 3, 0.5)).norm() < 1e-12);
    CHECK(in_root_frame({scene, "table"}, robot).error().message ==
          "s: expected a link of robot lifter as frame, got \"table\"");
    CHECK(in_root_frame({scene, "arm"}, robot).error().code == ErrorCode::unsupported);
  }
}

Problem read_back(const Problem& problem, const std::string& robot) {
  const TemporaryDirectory directory;
  write_file(directory / "p.yaml", to_yaml(problem, robot));
  return require(load_problem(directory / "p.yaml"));
}

TEST_SUITE("unit") {
  TEST_CASE("a problem is written with its scene inside") {
    const Problem problem{.name = "p",
                          .robot = planar8(),
                          .scene = make_circle_scene("s", {{1, 2, 0.5}}),
                          .start = {0.1},
                          .goals = {{0.2}}};
    CHECK(to_yaml(problem, "planar8") ==
          "name: p\n"
          "robot: planar8\n"
          "joints: [joint_1, joint_2, joint_3, joint_4, joint_5, joint_6, joint_7, joint_8]\n"
          "scene:\n"
          "  name: s\n"
          "  obstacles:\n"
          "    - {name: circle_1, type: sphere, position: [1, 2, 0], radius: 0.5}\n"
          "start: [0.1]\n"
          "goal: [0.2]\n");
  }

  TEST_CASE("several goals, an empty scene and NaN read back") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const Problem problem{.name = "a: b",
                          .robot = planar8(),
                          .scene = {"", {}},
                          .start = {nan, 1.0 / 3},
                          .goals = {{1}, {2}}};
    const Problem read = read_back(problem, "planar8");
    CHECK(read.name == "a: b");
    CHECK(std::isnan(read.start.at(0)));
    CHECK(read.start.at(1) == 1.0 / 3);
    CHECK(read.goals == problem.goals);
    CHECK(read.scene.obstacles.empty());
  }

  TEST_CASE("velocities at start and goal read back from both kinds of file") {
    Problem problem{.name = "p",
                    .robot = planar8(),
                    .scene = {"", {}},
                    .start = Configuration(8, 0.1),
                    .goals = {Configuration(8, 0.2)}};
    problem.start_velocity = Configuration(8, 0.25);
    problem.end_velocity = Configuration(8, -0.5);
    const TemporaryDirectory directory;
    write_file(directory / "p.json", to_compact_json(problem, "planar8"));
    const auto compact = require(load_problem(directory / "p.json#p"));
    for (const Problem& read : {read_back(problem, "planar8"), compact}) {
      CHECK(read.start_velocity == problem.start_velocity);
      CHECK(read.end_velocity == problem.end_velocity);
    }
  }

  TEST_CASE("the group and the fixed joints read back") {
    const TemporaryDirectory directory;
    write_file(directory / "lifter.urdf", kLiftUrdf);
    const auto robot = require(load_robot(
        directory / "lifter.urdf", {.joints = {"turn", "lift"}, .fixed_values = {{"grip", 0.03}}}));
    const Problem problem{
        .name = "p", .robot = robot, .scene = {"s", {}}, .start = {0, 0}, .goals = {{1, 1}}};
    CHECK(read_back(problem, directory / "lifter.urdf").robot.hash() == robot.hash());
  }

  TEST_CASE("a group reads back whatever groups the robot's SRDF has") {
    const TemporaryDirectory directory;
    write_file(directory / "lifter.urdf", kLiftUrdf);
    const auto robot =
        require(load_robot(directory / "lifter.urdf", {.joints = {"lift", "turn", "grip"}}));
    write_file(directory / "lifter.srdf", R"(<robot name="lifter">
      <group name="arm"><joint name="turn"/></group></robot>)");
    const Problem problem{
        .name = "p", .robot = robot, .scene = {"s", {}}, .start = {0, 0, 0}, .goals = {{1, 1, 0}}};
    CHECK(read_back(problem, directory / "lifter.urdf").robot.joint_count() == 3);
  }
}

}  // namespace
}  // namespace mneme::test
