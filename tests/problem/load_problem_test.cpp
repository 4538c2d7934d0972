// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/problem.h"

#include "support/support.h"

namespace mneme::test {
namespace {

TEST_SUITE("unit") {
  TEST_CASE("the scene may stand in the problem's file or in one of its own") {
    const TemporaryDirectory directory;
    const std::string rest = "robot: planar8\nstart: [0]\ngoal: [0]\n";
    write_file(directory / "scene.yaml", "circles: {a: [1, 2, 3]}\n");
    write_file(directory / "inside.yaml", rest + "scene: {circles: {a: [1, 2, 3]}}\n");
    write_file(directory / "beside.yaml", rest + "scene: scene.yaml\nname: other\n");
    const auto inside = load_problem(directory / "inside.yaml");
    REQUIRE_MESSAGE(inside.has_value(), (inside ? "" : inside.error().message));
    CHECK(inside->name == "inside");
    CHECK(inside->scene.name == "inside");
    CHECK(inside->scene.obstacles.at(0).name == "a");
    const auto beside = load_problem(directory / "beside.yaml");
    REQUIRE_MESSAGE(beside.has_value(), (beside ? "" : beside.error().message));
    CHECK(beside->name == "other");
    CHECK(beside->scene.name == "scene");
    CHECK(beside->scene.obstacles.at(0).name == "a");
  }

  TEST_CASE("errors name the file that they are in") {
    const TemporaryDirectory directory;
    const std::string rest = "robot: planar8\nstart: [0]\ngoal: [0]\n";
    const auto failure = [&](const std::string& text) {
      write_file(directory / "p.yaml", text);
      const auto problem = load_problem(directory / "p.yaml");
      REQUIRE_FALSE(problem.has_value());
      return problem.error().message.substr((directory / "").size());
    };
    write_file(directory / "bad.yaml", "\ncircles: {a: [1, 2]}\n");
    CHECK(
        failure(rest + "scene: bad.yaml") ==
        "bad.yaml:2: key circles.a: expected 3 numbers (x, y, radius in metres), got a list of 2");
    CHECK(failure(rest + "scene: {circles: {a: [1, 2]}}") ==
          "p.yaml:4: key scene.circles.a: expected 3 numbers (x, y, radius in metres), got a list "
          "of 2");
    CHECK(failure(rest + "scene: lost.yaml") ==
          "lost.yaml: cannot be read: No such file or directory");
    CHECK(failure(rest + "scene: [a]") ==
          "p.yaml:4: key scene: expected a scene, or the path of a scene file, got a list of 1");
    CHECK(failure(rest) == "p.yaml:1: expected the key scene, which is missing");
    CHECK(failure(rest + "scene: {}\nplanner: rrt") ==
          "p.yaml:5: key planner: unknown key, expected one of name, robot, srdf, group, joints, "
          "fixed_joints, frame, scene, start, goal, goals");
    CHECK(failure("circles: {a: [1, 2, 1]}") ==
          "p.yaml:1: this is a scene; expected a problem, which names robot, scene, start and "
          "goal");
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
      const auto problem = load_problem(file.path().string());
      REQUIRE_MESSAGE(problem.has_value(), (problem ? "" : problem.error().message));
      CHECK(problem->name == file.path().stem());
      CHECK_FALSE(problem->robot.describe_violation(problem->start, "start"));
      CHECK_FALSE(problem->robot.describe_violation(problem->goals.at(0), "goal"));
      CHECK(problem->scene.obstacles.size() >= 2);
      ++count;
    }
    CHECK(count >= 6);
  }
}

}  // namespace
}  // namespace mneme::test
