// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/moveit_files.h"
#include "problem/moveit_problem.h"
#include "problem/problem_input.h"
#include "problem/small_robots.h"
#include "scene/read_yaml.h"
#include "support/support.h"

#include <doctest/doctest.h>

namespace mneme::test {
namespace {

using internal::read_moveit_request;

std::string request_failure(const std::string& yaml) {
  return failure_of(yaml, read_moveit_request);
}

const std::string kGoal =
    "goal_constraints: [{joint_constraints: [{joint_name: a, position: 1}]}]\n";

TEST_SUITE("unit") {
  TEST_CASE("a goal is what its tolerances allow") {
    const auto request = require(read_yaml(
        "group_name: arm\nplanner_id: RRT\nworkspace_parameters: {min_corner: [0, 0, 0]}\n"
        "goal_constraints:\n"
        "  - joint_constraints: [{joint_name: a, position: 1, tolerance_above: 0.4, "
        "tolerance_below: 0.2, weight: 1}]\n"
        "    position_constraints: []\n"
        "  - joint_constraints: [{joint_name: a, position: 2}]\n"
        "path_constraints: {joint_constraints: []}\ntrajectory_constraints:\n",
        [](const internal::Input& input) {
          auto read = read_moveit_request(input);
          read.goal_places.clear();
          return read;
        }));
    CHECK(request.group == "arm");
    REQUIRE(request.goals.size() == 2);
    CHECK(request.goals[0].at("a").least == doctest::Approx(0.8));
    CHECK(request.goals[0].at("a").most == doctest::Approx(1.4));
    CHECK(request.goals[1].at("a").least == 2);
    CHECK(request.goals[1].at("a").most == 2);
  }

  TEST_CASE("goals and paths that are constrained otherwise are refused by name") {
    CHECK(request_failure("goal_constraints:\n  - visibility_constraints: [{weight: 1}]") ==
          "f:2: key goal_constraints[0].visibility_constraints: visibility_constraints are not "
          "supported; expected a goal without them");
    CHECK(
        request_failure(kGoal + "path_constraints: {position_constraints: [{link_name: hand}]}") ==
        "f:2: key path_constraints.position_constraints: position_constraints are not "
        "supported; expected a path without constraints other than of orientation");
    CHECK(request_failure(kGoal + "path_constraints: {joint_constraints: [{joint_name: a}]}") ==
          "f:2: key path_constraints: joint_constraints are not supported here; expected a path "
          "without constraints other than of orientation");
    CHECK(
        request_failure(kGoal + "trajectory_constraints: {constraints: [{}]}") ==
        "f:2: key trajectory_constraints: trajectory_constraints are not supported; expected none");
  }

  TEST_CASE("requests that are malformed are refused with line and key") {
    CHECK(request_failure("group_name: arm") ==
          "f:1: expected the key goal_constraints, which is missing");
    CHECK(request_failure("goal_constraints: []") ==
          "f:1: key goal_constraints: expected at least one goal, got a list of 0");
    CHECK(request_failure("goal_constraints: [{name: g}]") ==
          "f:1: key goal_constraints[0]: expected joint_constraints, got none");
    CHECK(request_failure("goal_constraints: [{joint_constraints: [{joint_name: a}]}]") ==
          "f:1: key goal_constraints[0].joint_constraints[0]: expected the key position, which is "
          "missing");
    CHECK(request_failure("goal_constraints: [{joint_constraints: [{joint_name: a, position: 1, "
                          "tolerance_below: -1}]}]") ==
          "f:1: key goal_constraints[0].joint_constraints[0].tolerance_below: expected a tolerance "
          "of 0 or more, got -1");
    CHECK(request_failure("goal_constraints: [{joint_constraints: [{joint_name: a, position: 1}, "
                          "{joint_name: a, position: 1}]}]") ==
          "f:1: key goal_constraints[0].joint_constraints[1].joint_name: expected each joint once, "
          "got a again");
    CHECK(request_failure(kGoal + "goal: 1").find("f:2: key goal: unknown key, expected one of ") ==
          0);
  }
}

using internal::Input;

/// Pairs that a matrix allows of the lifter, a cup, a second obstacle, and a lid that its arm
/// carries.
struct Allowed {
  std::vector<std::pair<std::string, std::string>> links;
  std::vector<std::string> cup, box, lid;
  std::vector<std::string> warnings;
};

using Names = std::vector<std::string>;

Result<Allowed> read_matrix(const std::string& matrix, const std::string& box = "box") {
  return read_yaml("allowed_collision_matrix:\n" + matrix, [&box](const Input& input) {
    const Robot robot = parse_robot(kLiftUrdf, "lifter.urdf").value();
    Scene scene{"two", {{"cup", {Sphere{}}}, {box, {Sphere{}}}}};
    std::vector<AttachedObject> attached = {{"lid", "arm", {}}};
    Names names = {"lid", "cup", box};
    for (const Link& link : robot.links()) names.push_back(link.name);
    internal::AllowedContacts contacts(robot, attached, scene);
    const auto warnings = internal::read_moveit_allowed(input, names, contacts);
    return Allowed{contacts.link_pairs(), scene.obstacles[0].may_touch,
                   scene.obstacles[1].may_touch, attached[0].may_touch, warnings};
  });
}

TEST_SUITE("unit") {
  TEST_CASE("pairs of links that may touch are found, once each") {
    const auto allowed = require(
        read_matrix("  entry_names: [arm, base, finger, cup]\n"
                    "  entry_values: [[false, true, false, false], [true, true, false, false],\n"
                    "    {enabled: [false, false, true, false]}, [false, false, false, true]]\n"));
    CHECK(allowed.links == std::vector<std::pair<std::string, std::string>>{{"arm", "base"}});
    CHECK(allowed.cup.empty());
    CHECK(allowed.warnings.empty());
  }

  TEST_CASE("objects may touch each other, and names that nobody has are left aside") {
    const auto allowed = require(read_matrix(
        "  entry_names: [cup, box, ghost, arm]\n"
        "  entry_values: [[false, true, true, false], [true, false, false, false],\n"
        "    [true, false, false, true], [false, false, true, false]]\n"
        "  default_entry_names: [spirit, arm]\n  default_entry_values: [true, false]\n"));
    CHECK(allowed.links.empty());
    CHECK(allowed.cup.empty());
    REQUIRE(allowed.warnings.size() == 1);
    CHECK(allowed.warnings[0] ==
          "f:2: key allowed_collision_matrix: ignored, because there is no such link or object: "
          "ghost, spirit");
  }

  TEST_CASE("links and attached objects that may touch an object are found") {
    const auto allowed = require(
        read_matrix("  entry_names: [cup, arm, lid, box]\n"
                    "  entry_values: [[false, true, true, true], [true, false, false, false],\n"
                    "    [true, false, false, false], [true, false, false, false]]\n"));
    CHECK(allowed.cup == Names{"arm", "lid"});
    CHECK(allowed.box.empty());
    CHECK(allowed.lid.empty());
    CHECK(allowed.links.empty());
  }

  TEST_CASE("defaults count for what has no entry, those of both names if both have one") {
    const auto allowed = require(
        read_matrix("  entry_names: [cup, arm]\n  entry_values: [[false, false], [false, false]]\n"
                    "  default_entry_names: [cup, finger, base]\n"
                    "  default_entry_values: [true, true, false]\n"));
    CHECK(allowed.cup == Names{"lid", "world", "carriage", "finger"});
    CHECK(allowed.box == Names{"finger"});
    CHECK(allowed.lid == Names{"finger"});
    CHECK(allowed.links.size() == 3);
  }

  TEST_CASE("pairs of a name with two meanings are left aside") {
    const std::string matrix =
        "  entry_names: [cup, arm, finger]\n"
        "  entry_values: [[false, true, true], [true, false, true], [true, true, false]]\n";
    const auto allowed = require(read_matrix(matrix, "finger"));
    CHECK(allowed.cup == Names{"arm"});
    CHECK(allowed.box.empty());
    CHECK(allowed.links.empty());
    REQUIRE(allowed.warnings.size() == 1);
    CHECK(allowed.warnings[0] ==
          "f:2: key allowed_collision_matrix: ignored, because names have two meanings: \"finger\" "
          "is a link of robot lifter and an obstacle; rename the obstacle");
  }

  TEST_CASE("matrices that are malformed are refused with line and key") {
    CHECK(read_matrix("  entry_names: [a, b]\n  entry_values: [[true, true]]\n").error().message ==
          "f:2: key allowed_collision_matrix: expected one row per name, got 1 for 2 names");
    CHECK(
        read_matrix("  entry_names: [a]\n  entry_values: [[true, true]]\n").error().message ==
        "f:3: key allowed_collision_matrix.entry_values[0]: expected one value per name, got 2 for "
        "1 names");
    CHECK(read_matrix("  entry_names: [a]\n  entry_values: [[1]]\n").error().message ==
          "f:3: key allowed_collision_matrix.entry_values[0][0]: expected true or false, got 1");
    CHECK(read_matrix("  entry_names: [a, b]\n  entry_values: [[true, true], [false, true]]\n")
              .error()
              .message ==
          "f:3: key allowed_collision_matrix.entry_values[1]: expected a symmetric "
          "matrix of allowed collisions, got two values for a and b");
    CHECK(read_matrix("  default_entry_names: [a]\n").error().message ==
          "f:2: key allowed_collision_matrix: expected one default value per name, got 0 for 1 "
          "names");
  }
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

TEST_SUITE("unit") {
  TEST_CASE("a request finds the scene beside it by its number, or it is named first") {
    const auto beside = [](const std::string& path) {
      return read_yaml("{}",
                       [&](const Input& input) { return internal::scene_of_request(input, path); });
    };
    CHECK(beside("a/request0001.yaml").value() == "a/scene0001.yaml");
    CHECK(beside("requests/my_request_7.yml").value() == "requests/my_scene_7.yml");
    CHECK(beside("requests/query.yaml").error().message ==
          "f:1: the scene of this motion plan request is unknown; expected a file name with "
          "\"request\" in it, or SCENE.yaml,requests/query.yaml");
    CHECK(internal::split_moveit_address("a.yaml,b.yaml")->request == "b.yaml");
    CHECK(internal::split_moveit_address("a,b.yml,c")->scene == "a,b.yml");
    CHECK_FALSE(internal::split_moveit_address("a,b.yaml"));
  }

  TEST_CASE("start, goal, fixed joints and obstacles come from both files") {
    MoveitFiles files;
    files.options.start_velocity = {0.1, 0.2};
    const auto problem = require(files.load());
    CHECK(problem.start_velocity == Configuration{0.1, 0.2});
    CHECK(problem.end_velocity.empty());
    CHECK(problem.name == "request0001");
    CHECK(problem.start == Configuration{0.1, 0.5});
    REQUIRE(problem.goals.size() == 1);
    CHECK(problem.goals[0][0] == 0.75);
    CHECK(problem.goals[0][1] == doctest::Approx(1.05));
    for (const Joint& joint : problem.robot.joints()) {
      if (joint.name == "grip") CHECK(joint.fixed_value == 0.03);
    }
    const auto ball = std::get<Sphere>(problem.scene.obstacles.at(0).shapes.at(0));
    CHECK((ball.center - Vec3(-1, 0, 0.5)).norm() < 1e-12);
    CHECK(problem.warnings.empty());
    const auto same =
        load_problem(files / "scene0001.yaml" + "," + files / "request0001.yaml", files.options);
    REQUIRE(same.has_value());
    CHECK(same->start == problem.start);
  }

  TEST_CASE("planar and floating joints of the robot stand where the state says") {
    MoveitFiles files(kMoveitScene +
                      "  multi_dof_joint_state: {joint_names: [drive, virtual], header: {frame_id: "
                      "odom}, transforms: [{translation: [1, 2, 0], rotation: [0, 0, 1, 0]}, "
                      "{translation: [5, 0, 0], rotation: [0, 0, 0, 1]}]}\n");
    const std::string drive =
        "<link name=\"map\"/><joint name=\"drive\" type=\"planar\"><parent link=\"map\"/>"
        "<child link=\"world\"/></joint></robot>";
    write_file(files / "lifter.urdf", replaced(kLiftUrdf, "</robot>", drive));
    const auto problem = require(files.load());
    const Robot& robot = problem.robot;
    const auto link = static_cast<std::size_t>(*robot.find_link("world"));
    CHECK((robot.link_poses(problem.start)[link].translation - Vec3(1, 2, 0)).norm() < 1e-12);
    CHECK(robot.link_poses(problem.start)[link].rotation(0, 0) == doctest::Approx(-1));
    // The written problem has the joint's values, too.
    const std::string yaml = to_yaml(problem, files / "lifter.urdf");
    CHECK(contains(yaml, "drive/x"));
  }

  TEST_CASE("the frame of a fixed virtual joint is the root link's") {
    MoveitFiles files(replaced(kMoveitScene, "frame_id: base", "frame_id: map"));
    const std::string joint =
        "<robot name='lifter'><virtual_joint name='v' type='fixed' parent_frame='map' "
        "child_link='world'/></robot>";
    CHECK(contains(files.failure(), "got \"map\""));
    write_file(files / "lifter.srdf", joint);
    const auto problem = files.load();
    REQUIRE_MESSAGE(problem.has_value(), (problem ? "" : problem.error().message));
    const auto ball = std::get<Sphere>(problem->scene.obstacles.at(0).shapes.at(0));
    CHECK(ball.center == Vec3(0, 1, 0));
    write_file(files / "lifter.srdf", replaced(joint, "fixed", "floating"));
    CHECK(contains(files.failure(), "got \"map\""));
  }

  TEST_CASE("a goal is the middle of what tolerances and limits allow") {
    const MoveitFiles files;
    const auto problem = require(files.load());
    const double upper = problem.robot.group_joint(1).upper;
    const MoveitFiles wide(kMoveitScene,
                           replaced(kMoveitRequest, "tolerance_above: 0.2", "tolerance_above: 90"));
    REQUIRE_MESSAGE(wide.load().has_value(), wide.load().error().message);
    CHECK(wide.load()->goals[0][1] == doctest::Approx(0.5 * (0.9 + upper)));
  }

  TEST_CASE("how fast a request wants to be is left aside with a warning") {
    const MoveitFiles files(kMoveitScene, kMoveitRequest +
                                              "max_velocity_scaling_factor: 0.1\n"
                                              "max_acceleration_scaling_factor: 1\n");
    const auto problem = require(files.load());
    REQUIRE(problem.warnings.size() == 1);
    CHECK(contains(problem.warnings[0], "max_velocity_scaling_factor is ignored"));
  }

  TEST_CASE("start and goal of the caller stand for those of the request") {
    MoveitFiles files;
    files.options.start = Configuration{0, 0};
    files.options.goal = Configuration{1, 1};
    CHECK(files.load().value().start == Configuration{0, 0});
    CHECK(files.load().value().goals == std::vector<Configuration>{{1, 1}});
  }

  TEST_CASE("joints that the robot lacks are left aside with a warning") {
    const MoveitFiles files(replaced(kMoveitScene, "grip], position: [0.1, 0.2, 0.03]",
                                     "wheel], position: [0.1, 0.2, 0]"));
    const auto problem = require(files.load());
    REQUIRE(problem.warnings.size() == 1);
    CHECK(contains(problem.warnings[0], "ignored for robot lifter: wheel (no such joint)"));
  }

  TEST_CASE("pairs of links that may touch are not checked") {
    RobotOptions options;
    options.joints = {"lift", "turn"};
    const MoveitFiles files(kMoveitScene +
                            "allowed_collision_matrix: {entry_names: [arm, base], entry_values: "
                            "[[false, true], [true, false]]}\n");
    CHECK(require(files.load()).robot.self_pairs().empty());
  }

  TEST_CASE("an attached object stays where it is at the start, seen from its link") {
    const std::string attached =
        "  attached_collision_objects: [{link_name: finger, touch_links: [base, ghost], object: "
        "{id: "
        "cup, header: {frame_id: base}, primitives: [{type: sphere, dimensions: [0.1]}], "
        "primitive_poses: [{position: [1, 0, 0.2], orientation: [0, 0, 0, 1]}]}},\n"
        "    {link_name: arm, object: {id: ball}}]\n";
    const MoveitFiles files(kMoveitScene + attached +
                            "allowed_collision_matrix: {entry_names: [ball, cup], entry_values: "
                            "[[false, true], [true, false]]}\n");
    const auto problem = require(files.load());
    // The world's ball is attached, too, and not in the world any more.
    CHECK(problem.scene.obstacles.empty());
    const auto carried = problem.robot.attached();
    REQUIRE(carried.size() == 2);
    CHECK(carried[0].object.name == "cup");
    CHECK(carried[0].object.link == "finger");
    CHECK(carried[0].object.may_touch == Names{"base"});
    CHECK(carried[1].object.may_touch == Names{"cup"});
    const std::vector<Transform> poses = problem.robot.link_poses(problem.start);
    const std::size_t links = poses.size();
    // Where they are at the start, in the root's frame; "base" is turned by a quarter about z.
    CHECK((poses[links - 2] * carried[0].spheres.at(0).center).isApprox(Vec3(0, 1, 0.7), 1e-9));
    CHECK((poses[links - 1] * carried[1].spheres.at(0).center).isApprox(Vec3(-1, 0, 0.5), 1e-9));
    REQUIRE(problem.warnings.size() == 1);
    CHECK(contains(problem.warnings[0], "ignored, because there is no such touch link: ghost"));
  }

  TEST_CASE("an object in the frame of its own link needs no start of the scene") {
    const auto scene_with_frame = [](const std::string& frame) {
      return replaced(kMoveitScene, "name: [lift,", "name: [wheel,") +
             "  attached_collision_objects: [{link_name: finger, object: {id: cup, header: "
             "{frame_id: " +
             frame +
             "}, primitives: [{type: sphere, dimensions: [0.1]}], "
             "primitive_poses: [{position: [0, 0, 0.2], orientation: [0, 0, 0, 1]}]}}]\n";
    };
    MoveitFiles of_finger(scene_with_frame("finger")), of_base(scene_with_frame("base"));
    of_finger.options.start = of_base.options.start = Configuration{0.5, 0.5};
    const auto problem = require(of_finger.load());
    CHECK(problem.robot.attached()[0].spheres.at(0).center.isApprox(Vec3(0, 0, 0.2), 1e-9));
    CHECK(contains(of_base.failure(), "expected a start position of joint lift"));
  }

  TEST_CASE("attached objects that nothing carries or that have no shape are refused") {
    const auto failure = [](const std::string& attached) {
      return MoveitFiles(kMoveitScene + "  attached_collision_objects: [" + attached + "]\n")
          .failure();
    };
    const std::string shape =
        "primitives: [{type: sphere, dimensions: [0.1]}], pose: {position: [0, 0, 0]}";
    CHECK(
        failure("{link_name: hand, object: {id: cup, " + shape + "}}") ==
        "scene0001.yaml:11: key robot_state.attached_collision_objects[0].object: expected a link "
        "of robot lifter to carry \"cup\", got \"hand\"");
    CHECK(failure("{link_name: arm, object: {id: arm, " + shape + "}}") ==
          "scene0001.yaml:11: key robot_state.attached_collision_objects[0].object: expected a "
          "unique "
          "name, got \"arm\", a link");
    CHECK(
        failure("{link_name: arm, object: {id: cup}}") ==
        "scene0001.yaml:11: key robot_state.attached_collision_objects[0].object: object \"cup\": "
        "expected primitives, or an object of this name in the world");
    CHECK(
        failure("{link_name: arm, object: {id: sheet, planes: [{coef: [0, 0, 1, 0]}], plane_poses: "
                "[{position: [0, 0, 0]}]}}") ==
        "scene0001.yaml:11: key robot_state.attached_collision_objects[0].object: object "
        "\"sheet\": expected shapes without planes to attach, got a plane");
  }

  TEST_CASE("problems that cannot be read exactly are refused by name") {
    const auto with_scene = [](const std::string& from, const std::string& to) {
      return MoveitFiles(replaced(kMoveitScene, from, to)).failure();
    };
    const auto with_request = [](const std::string& from, const std::string& to) {
      return MoveitFiles(kMoveitScene, replaced(kMoveitRequest, from, to)).failure();
    };
    CHECK(
        with_scene("frame_id: base", "frame_id: table") ==
        "scene0001.yaml:5: key world.collision_objects[0]: expected a frame that is a link of the "
        "robot or one of the fixed_frame_transforms, got \"table\"");
    CHECK(
        with_scene("frame_id: base", "frame_id: arm") ==
        "scene0001.yaml:5: key world.collision_objects[0]: expected the root link of robot lifter "
        "or one fixed to it, got \"arm\", which joint turn moves");
    CHECK(contains(with_scene("type: sphere", "type: prism"), "object \"ball\" has a prism"));
    CHECK(
        with_scene("[lift, turn, grip], position: [0.1,", "[wheel, turn, grip], position: [0.1,") ==
        "request0001.yaml:1: expected a start position of joint lift of the planning group, got "
        "none");
    CHECK(with_request("joint_name: lift", "joint_name: spin") ==
          "request0001.yaml:4: key goal_constraints[0]: expected positions of joints of the "
          "planning group, got one of spin; the robot is lifter");
    CHECK(with_request("joint_name: lift", "joint_name: grip") ==
          "request0001.yaml:4: key goal_constraints[0]: expected positions of joints of the "
          "planning group, got one of grip; the robot is lifter");
    CHECK(with_request("      - {joint_name: lift, position: 0.75}\n", "") ==
          "request0001.yaml:4: key goal_constraints[0]: expected a goal position of joint lift "
          "of the planning group, got none");
  }

  TEST_CASE("a robot that is not known, and a scene without request, are refused") {
    MoveitFiles files;
    const Error error = require_error(load_problem(files / "scene0001.yaml", files.options));
    CHECK(contains(error.message,
                   "scene0001.yaml:1: this is a planning scene without start and "
                   "goal; expected its motion plan request"));
    files.options.robot_path.clear();
    CHECK(files.failure().find("scene0001.yaml:2: key robot_model_name: ") == 0);
    std::filesystem::remove(files / "scene0001.yaml");
    CHECK(files.load().error().code == ErrorCode::io);
  }
}

/// The problem `number` of a set as compact JSON.
Result<Problem> load_compact(const std::string& set, const std::string& number,
                             const ProblemOptions& options) {
  return load_problem(*data_file("mbm/fetch/" + set + ".json") + "#" + number, options);
}

double distance(const Configuration& a, const Configuration& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

void check_same_shape(const Shape& a, const Shape& b) {
  REQUIRE(a.index() == b.index());
  if (const auto* box = std::get_if<Box>(&a)) {
    const auto& other = std::get<Box>(b);
    CHECK((box->pose.translation - other.pose.translation).norm() < 1e-6);
    CHECK((box->pose.rotation - other.pose.rotation).norm() < 1e-6);
    CHECK((box->half_extents - other.half_extents).norm() < 1e-6);
  }
  if (const auto* cylinder = std::get_if<Cylinder>(&a)) {
    const auto& other = std::get<Cylinder>(b);
    CHECK((cylinder->pose.translation - other.pose.translation).norm() < 1e-6);
    CHECK((cylinder->pose.rotation - other.pose.rotation).norm() < 1e-6);
    CHECK(std::abs(cylinder->radius - other.radius) < 1e-6);
    CHECK(std::abs(cylinder->length - other.length) < 1e-6);
  }
}

TEST_SUITE("flow") {
  TEST_CASE("MotionBenchMaker's files say what the compact ones say") {
    const auto root = data_file("mbm/moveit_yaml");
    const auto urdf = data_file("../robots/spherized/fetch_spherized.urdf");
    const auto srdf = data_file("../robots/spherized/fetch.srdf");
    if (!root || !urdf || !srdf) return;
    ProblemOptions options;
    options.robot_path = *urdf;
    options.robot.srdf_path = *srdf;
    for (const std::string set : {"cage", "box", "bookshelf_thin"}) {
      for (const std::string number : {"1", "3", "5"}) {
        INFO(set << " " << number);
        const auto moveit =
            load_problem(*root + "/" + set + "_fetch/request000" + number + ".yaml", options);
        REQUIRE_MESSAGE(moveit.has_value(), (moveit ? "" : moveit.error().message));
        const auto compact = require(load_compact(set, number, options));
        CHECK(moveit->robot.hash() == compact.robot.hash());
        CHECK(distance(moveit->start, compact.start) < 1e-6);
        CHECK(distance(moveit->goals.at(0), compact.goals.at(0)) < 1e-6);
        REQUIRE(moveit->scene.obstacles.size() == compact.scene.obstacles.size());
        for (std::size_t i = 0; i < moveit->scene.obstacles.size(); ++i) {
          REQUIRE(moveit->scene.obstacles[i].name == compact.scene.obstacles[i].name);
          check_same_shape(moveit->scene.obstacles[i].shapes.at(0),
                           compact.scene.obstacles[i].shapes.at(0));
        }
      }
    }
  }
}

}  // namespace
}  // namespace mneme::test
