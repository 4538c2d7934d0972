// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/compact_file.h"
#include "support/support.h"

#include <algorithm>

namespace mneme::test {
namespace {

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
    const auto problem = load_problem(path() + where_after_path);
    REQUIRE_FALSE(problem.has_value());
    std::string message = problem.error().message;
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
    CHECK(problem(", \"obstacles\": [{\"name\": \"x\", \"type\": \"mesh\"}]" + ends) ==
          "p.json:2: key problems[0].obstacles[0].type: expected sphere, box, cylinder or capsule, "
          "got \"mesh\"");
    CHECK(problem(", \"circles\": [], \"links\": [1, 2]" + ends)
              .find("p.json:2: key problems[0].links: expected the lengths of robot planar8's") ==
          0);
    CHECK(problem(", \"circles\": [], \"joint_limits\": [-1, 1]" + ends)
              .find("p.json:2: key problems[0].joint_limits: expected the limits of robot") == 0);
  }

  TEST_CASE("a file that is missing is an io error") {
    const auto problem = load_problem("/nonexistent.json#a");
    REQUIRE_FALSE(problem.has_value());
    CHECK(problem.error().code == ErrorCode::io);
    CHECK(list_problems("/nonexistent.json").error().code == ErrorCode::io);
  }
}

/// Loads every problem of a file with the given robot and checks what all of them have in common.
void check_file(const std::string& path, const std::string& robot_path, int joint_count) {
  const auto names = list_problems(path);
  REQUIRE_MESSAGE(names.has_value(), (names ? "" : names.error().message));
  ProblemOptions options;
  options.robot_path = robot_path;
  for (const std::string& name : *names) {
    const auto problem = load_problem(path + "#" + name, options);
    REQUIRE_MESSAGE(problem.has_value(), (problem ? "" : problem.error().message));
    REQUIRE(problem->robot.joint_count() == joint_count);
    REQUIRE_FALSE(problem->robot.describe_violation(problem->start, "start"));
    REQUIRE_FALSE(problem->robot.describe_violation(problem->goals.at(0), "goal"));
    REQUIRE_FALSE(problem->scene.obstacles.empty());
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

}  // namespace
}  // namespace mneme::test
