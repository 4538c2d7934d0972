// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/base.h"
#include "mneme/problem.h"

#include "problem/problem_input.h"
#include "problem/small_robots.h"
#include "support/support.h"

#include <doctest/doctest.h>

#include <cstdint>

namespace mneme::test {
namespace {

const std::string kSource = "f";

using internal::Input;
using internal::InputValue;

std::string json_failure(const std::string& json) {
  const auto result =
      internal::without_throwing([&] { return internal::parse_json(json, "f.json"); });
  return result ? "" : result.error().message;
}

TEST_SUITE("unit") {
  TEST_CASE("values are read with their types") {
    const InputValue value =
        internal::parse_json(R"({"a": [1, -2, 0.5, 1e3], "b": "1", "c": null, "d": true})", "f");
    const Input input(value, kSource);
    CHECK(input.at("a").numbers() == std::vector<double>{1, -2, 0.5, 1000});
    CHECK(input.at("b").text() == "1");
    CHECK(input.entries().size() == 4);
    const Error error =
        require_error(internal::without_throwing([&] { return input.at("b").number(); }));
    CHECK(error.message == "f:1: key b: expected a number, got \"1\"");
  }

  TEST_CASE("whole numbers are exact up to 2^64 - 1") {
    const InputValue value = internal::parse_json(
        R"([9007199254740993, 18446744073709551615, 1e3, -1, 0.5, 18446744073709551616])", "f");
    std::vector<std::optional<std::uint64_t>> numbers;
    for (const Input& item : Input(value, kSource).items()) {
      numbers.push_back(item.whole_number());
    }
    CHECK(numbers == std::vector<std::optional<std::uint64_t>>{
                         9007199254740993U, ~std::uint64_t{0}, 1000U, {}, {}, {}});
    CHECK(Input(value, kSource).items()[1].number() == 0x1p64);
    const auto text =
        internal::without_throwing([&] { return Input(value, kSource).items()[0].text(); });
    REQUIRE_FALSE(text.has_value());
    CHECK(text.error().message == "f:1: key [0]: expected a text, got 9007199254740993");
  }

  TEST_CASE("every kind of value carries its line") {
    const InputValue value =
        internal::parse_json("{\n\"a\":\n1\n,\n\"b\":\n\"x\",\"c\":[\n2\n,3\n]\n}", "f");
    const auto& map = std::get<InputValue::Map>(value.content);
    CHECK(value.line == 1);
    CHECK(map[0].value.line == 3);
    CHECK(map[1].value.line == 6);
    CHECK(map[2].value.line == 6);
    const auto& list = std::get<InputValue::List>(map[2].value.content);
    CHECK(list[0].line == 7);
    CHECK(list[1].line == 8);
  }

  TEST_CASE("malformed text is refused with file, line and reason") {
    CHECK(json_failure("{\n\"a\": [1, 2,\n}").substr(0, 44) ==
          "f.json:3: expected JSON: syntax error while ");
    CHECK(json_failure("").substr(0, 25) == "f.json:1: expected JSON: ");
    CHECK(json_failure("[1] 2").substr(0, 25) == "f.json:1: expected JSON: ");
    CHECK(json_failure("[NaN]").substr(0, 25) == "f.json:1: expected JSON: ");
    CHECK(json_failure("[1,\n\n1e999]") ==
          "f.json:3: expected JSON: number overflow parsing '1e999'");
    CHECK(json_failure("[\"\xff\"]").substr(0, 25) == "f.json:1: expected JSON: ");
  }

  TEST_CASE("doubled keys and deep nesting are refused") {
    CHECK(json_failure("{\"a\": 1,\n\"a\": 2}") ==
          "f.json:2: key a: expected once, got a second time");
    CHECK(json_failure(std::string(100000, '[')) ==
          "f.json:1: expected values nested at most 64 deep");
    std::string objects;
    for (int i = 0; i < 1000; ++i) objects += "{\"a\":";
    CHECK(json_failure(objects) == "f.json:1: expected values nested at most 64 deep");
  }
}

TEST_SUITE("law") {
  TEST_CASE("any bytes are read or refused with the file's name") {
    Rng rng(91);
    const std::string letters = "{}[]\",:01e-. \nabtrue";
    for (int i = 0; i < 5000; ++i) {
      std::string bytes;
      const std::uint32_t count = rng.index(40);
      for (std::uint32_t j = 0; j < count; ++j) {
        bytes += i % 3 == 0 ? static_cast<char>(rng.index(256))
                            : letters[rng.index(static_cast<std::uint32_t>(letters.size()))];
      }
      INFO("seed 91, case " << i);
      const std::string message = json_failure(bytes);
      REQUIRE((message.empty() || message.rfind("f.json:", 0) == 0));
    }
  }
}

const std::string kTwo = R"({"robot": "planar8", "note": "a remark", "problems": [
  {"name": "one", "circles": [[1, 2, 0.5], [3, 4, 0.5]], "start": [0], "goal": [1], "gap": 3},
  {"index": 7, "start": [0], "goal": [1], "obstacles": [
    {"name": "x", "type": "box", "p": [1, 2, 3], "q": [1, 0, 0, 1], "size": [2, 4, 6]},
    {"name": "y", "body": "xyz", "type": "cylinder", "p": [1, 2, 3], "radius": 1, "length": 2},
    {"name": "z", "body": "xyz", "type": "sphere", "p": [1, 2, 3], "radius": 1}]},
  {"obstacles": [], "start": [0], "goal": [1]}
]})";

/// Problems of a file in a directory of its own.
struct File {
  explicit File(const std::string& text = kTwo) { write_file(path(), text); }
  std::string path() const { return directory / "p.json"; }
  Result<Problem> load(const std::string& name) const { return load_problem(path() + "#" + name); }
  /// The message of the failure without the directory.
  std::string failure(const std::string& where_after_path) const {
    const Error error = require_error(load_problem(path() + where_after_path));
    std::string message = error.message;
    const std::string prefix = directory / "";
    for (std::size_t at = message.find(prefix); at != std::string::npos;
         at = message.find(prefix)) {
      message.erase(at, prefix.size());
    }
    return message;
  }
  TemporaryDirectory directory;
};

TEST_SUITE("unit") {
  TEST_CASE("an address is split after the extension") {
    CHECK(internal::split_address("a/b.json#S1")->path == "a/b.json");
    CHECK(internal::split_address("a/b.json#S1")->name == "S1");
    CHECK(internal::split_address("a#b.json#c#d.json#")->path == "a#b.json");
    CHECK(internal::split_address("b.json")->name.empty());
    CHECK_FALSE(internal::split_address("b.yaml"));
    CHECK_FALSE(internal::split_address("b.yaml#S1"));
  }

  TEST_CASE("problems are found by name, by index, or by position") {
    const File file;
    CHECK(list_problems(file.path()).value() == std::vector<std::string>{"one", "7", "3"});
    CHECK(file.load("one").value().name == "one");
    CHECK(file.load("7").value().scene.obstacles.size() == 2);
    CHECK(file.load("3").value().scene.obstacles.empty());
  }

  TEST_CASE("circles are numbered, and obstacles have poses with quaternions w, x, y, z") {
    const File file;
    const Problem one = file.load("one").value();
    CHECK(one.scene.name == "one");
    CHECK(one.scene.obstacles[1].name == "circle_2");
    const Problem seven = file.load("7").value();
    const auto box = std::get<Box>(seven.scene.obstacles[0].shapes[0]);
    CHECK((box.pose * Vec3(1, 0, 0) - Vec3(1, 3, 3)).norm() < 1e-15);
    CHECK(box.half_extents == Vec3(1, 2, 3));
    CHECK(seven.scene.obstacles[1].name == "xyz");
    CHECK(seven.scene.obstacles[1].shapes.size() == 2);
  }

  TEST_CASE("with a cache problems share their robot, unless options make another") {
    const File file;
    ProblemOptions options;
    options.cache = make_problem_cache();
    const auto links_of = [&](const std::string& name) {
      return load_problem(file.path() + "#" + name, options).value().robot.links().data();
    };
    const Link* links = links_of("one");
    CHECK(links_of("7") == links);
    options.robot.allowed_pairs = {{"link_1", "link_3"}};
    CHECK(links_of("7") != links);
    options.robot.allowed_pairs.clear();
    CHECK(links_of("3") == links);
    CHECK(file.load("3").value().robot.links().data() != links);
  }

  TEST_CASE("an address without a name is refused with the first names") {
    const File file;
    const std::string expected =
        "p.json: expected the name of one of its 3 problems, as in p.json#one; the first are one, "
        "7, 3";
    CHECK(file.failure("") == expected);
    CHECK(file.failure("#") == expected);
  }

  TEST_CASE("an unknown name is refused with those that are close to it") {
    const File file;
    CHECK(file.failure("#On") ==
          "p.json: expected the name of one of its 3 problems, got \"On\"; the closest are one, 7, "
          "3");
  }

  TEST_CASE("files that are malformed are refused with line and key") {
    const auto refused = [](const std::string& text) { return File(text).failure("#a"); };
    const auto problem = [&](const std::string& members) {
      return refused("{\"robot\": \"planar8\", \"problems\": [\n{\"name\": \"a\"" + members +
                     "}]}");
    };
    const std::string ends = ", \"start\": [0], \"goal\": [0]";
    CHECK(refused("[]") == "p.json:1: expected a map, got a list of 0");
    CHECK(refused("{}") == "p.json:1: expected the key problems, which is missing");
    CHECK(refused("{\"problems\": 3}") == "p.json:1: key problems: expected a list, got 3");
    CHECK(refused("{\"problems\": []}") ==
          "p.json: expected at least one problem, got an empty list");
    CHECK(refused("{\"problems\": [1]}") == "p.json:1: key problems[0]: expected a map, got 1");
    CHECK(refused("{\"problems\": [{\"name\": 1}]}") ==
          "p.json:1: key problems[0].name: expected a text, got 1");
    CHECK(refused("{\"problems\": [{\"name\": \"a\"},\n{\"name\": \"a\"}]}") ==
          "p.json: expected one problem \"a\", got several");
    CHECK(refused("{\"problems\": [\n{\"name\": \"a\",}]}").find("p.json:2: expected JSON: ") == 0);
    CHECK(problem(ends) ==
          "p.json:2: key problems[0]: expected the key circles or obstacles, both are missing");
    CHECK(
        problem(", \"circles\": [[0, 0]]" + ends) ==
        "p.json:2: key problems[0].circles[0]: expected 3 numbers (x, y, radius in metres), got a "
        "list of 2");
    CHECK(problem(", \"circles\": [], \"start\": [null], \"goal\": [0]") ==
          "p.json:2: key problems[0].start[0]: expected a number, got nothing");
    CHECK(problem(", \"circles\": [], \"start\": [\"0\"], \"goal\": [0]") ==
          "p.json:2: key problems[0].start[0]: expected a number, got \"0\"");
    CHECK(problem(", \"obstacles\": [{\"name\": \"x\", \"type\": \"cone\"}]" + ends) ==
          "p.json:2: key problems[0].obstacles[0].type: expected sphere, box, cylinder, capsule, "
          "points, mesh or octree, got \"cone\"");
    CHECK(problem(", \"circles\": [], \"links\": [1, 2]" + ends)
              .find("p.json:2: key problems[0].links: expected the lengths of robot planar8's") ==
          0);
    CHECK(problem(", \"circles\": [], \"joint_limits\": [-1, 1]" + ends)
              .find("p.json:2: key problems[0].joint_limits: expected the limits of robot") == 0);
  }

  TEST_CASE("a file that is missing is an io error") {
    CHECK(require_error(load_problem("/nonexistent.json#a")).code == ErrorCode::io);
    CHECK(list_problems("/nonexistent.json").error().code == ErrorCode::io);
  }
}

/// Loads every problem of a file with the given robot and checks what all of them have in common.
void check_file(const std::string& path, const std::string& robot_path, int joint_count) {
  const auto names = require(list_problems(path));
  ProblemOptions options;
  options.robot_path = robot_path;
  options.robot.hard_limits = true;  // goals of Panda's problems are beyond its soft limits
  for (const std::string& name : names) {
    const auto problem = require(load_problem(path + "#" + name, options));
    REQUIRE(problem.robot.joint_count() == joint_count);
    REQUIRE_FALSE(problem.robot.describe_violation(problem.start, "start"));
    REQUIRE_FALSE(problem.robot.describe_violation(problem.goals.at(0), "goal"));
    REQUIRE_FALSE(problem.scene.obstacles.empty());
  }
}

TEST_SUITE("flow") {
  TEST_CASE("every planar problem of the data loads") {
    if (const auto path = data_file("planar/problems.json")) check_file(*path, "", 8);
  }

  TEST_CASE("every shelf problem of the data loads") {
    const auto path = data_file("fetch_shelf/problems.json");
    const auto robot = data_file("../robots/spherized/fetch_spherized.urdf");
    if (path && robot) check_file(*path, *robot, 8);
  }

  TEST_CASE("every benchmark problem of the data loads") {
    const std::vector<std::pair<std::string, int>> robots = {
        {"fetch", 8}, {"panda", 7}, {"ur5", 6}};
    for (const auto& [name, joint_count] : robots) {
      const auto directory = data_file("mbm/" + name);
      const auto robot = data_file("../robots/spherized/" + name + "_spherized.urdf");
      if (!directory || !robot) continue;
      if (const auto loaded = load_robot(*robot); !loaded) {
        MESSAGE("skipped: " << loaded.error().message);
        continue;
      }
      for (const auto& file : std::filesystem::directory_iterator(*directory)) {
        check_file(file.path().string(), *robot, joint_count);
      }
    }
  }
}

const Transform kPose{rotation_from_rpy({0.1, -0.2, 2.5}), {0.5, -0.25, 1.125}};

FramedScene strange_scene() {
  return {{"a: scene",
           {{"ball", {Sphere{{1, 2, 3}, 0.1}}},
            {"table", {Box{kPose, {0.1, 0.2, 0.3}}, Cylinder{kPose, 0.05, 0.7}}}}},
          "base_link"};
}

TEST_SUITE("unit") {
  TEST_CASE("a scene that is written as compact JSON reads back") {
    const TemporaryDirectory directory;
    FramedScene scene = strange_scene();
    scene.scene.obstacles.push_back({"bar", {Capsule{{1, 0, 0}, {0, 1, 0}, 0.02}}});
    write_file(directory / "s.json", to_compact_json(scene));
    const auto read = require(extract_scene(directory / "s.json" + "#a: scene"));
    CHECK(read.frame == "base_link");
    CHECK(read.scene.name == "a: scene");
    REQUIRE(read.scene.obstacles.size() == 3);
    const auto& box = std::get<Box>(read.scene.obstacles[1].shapes.at(0));
    CHECK((box.pose.rotation - kPose.rotation).norm() < 1e-12);
    CHECK(box.pose.translation == kPose.translation);
    CHECK(box.half_extents == Vec3(0.1, 0.2, 0.3));
    CHECK(std::get<Cylinder>(read.scene.obstacles[1].shapes.at(1)).length == 0.7);
    CHECK(std::get<Capsule>(read.scene.obstacles[2].shapes.at(0)).b == Vec3(0, 1, 0));
  }

  TEST_CASE("a problem that is written as compact JSON reads back, with all that it says") {
    const TemporaryDirectory directory;
    const std::string urdf = directory / "lifter.urdf";
    write_file(urdf, kLiftUrdf);
    ProblemOptions options;
    options.robot.joints = {"turn", "lift"};
    options.robot.fixed_values["grip"] = 0.02;
    auto loaded = require(load_robot(urdf, options.robot));
    const auto robot =
        attach(loaded, {{"rod", "finger", {Box{kPose, {0.1, 0.2, 0.3}}}, {}, {"carriage"}}});
    REQUIRE_MESSAGE(robot.has_value(), (robot ? "" : robot.error().message));
    const auto joints = static_cast<std::size_t>(robot->joint_count());
    Scene scene = strange_scene().scene;
    scene.obstacles[0].may_touch = {"arm", "rod"};
    PoseGoal goal{"finger", kPose, {0.1, 0.2, 0}, Axis::y, 0.5, kPi};
    const Problem problem{.name = "p 1",
                          .robot = *robot,
                          .robot_path = urdf,
                          .scene = scene,
                          .start = Configuration(joints, 0.1),
                          .goals = {Configuration(joints, -0.2)},
                          .pose_goals = {goal}};
    write_file(directory / "p.json", to_compact_json(problem, urdf));
    const auto read = require(load_problem(directory / "p.json" + "#p 1"));
    CHECK(read.name == "p 1");
    CHECK(read.start == problem.start);
    CHECK(read.goals == problem.goals);
    CHECK(read.robot.hash() == robot->hash());
    CHECK(read.scene.obstacles.size() == 2);
    CHECK(read.scene.obstacles[0].may_touch == scene.obstacles[0].may_touch);
    REQUIRE(read.robot.attached().size() == 1);
    const AttachedObject& rod = read.robot.attached()[0].object;
    CHECK(rod.link == "finger");
    CHECK(rod.may_touch == std::vector<std::string>{"carriage"});
    CHECK((std::get<Box>(rod.shapes.at(0)).pose.rotation - kPose.rotation).norm() < 1e-12);
    REQUIRE(read.pose_goals.size() == 1);
    const PoseGoal& same = read.pose_goals[0];
    CHECK(same.link == goal.link);
    CHECK((same.pose.rotation - goal.pose.rotation).norm() < 1e-12);
    CHECK(same.pose.translation == goal.pose.translation);
    CHECK(same.position_tolerance == goal.position_tolerance);
    CHECK(same.axis == Axis::y);
    CHECK(same.cone == 0.5);
    CHECK(same.turn == kPi);
  }

  TEST_CASE("a scene in the root link's frame names no frame") {
    CHECK(to_compact_json({{"s", {}}, ""}) ==
          "{\n \"problems\": [\n  {\n   \"name\": \"s\",\n   \"obstacles\": []\n  }\n ]\n}\n");
  }
}

}  // namespace
}  // namespace mneme::test
