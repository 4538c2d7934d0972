// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/problem_input.h"
#include "problem/small_robots.h"
#include "scene/yaml.h"
#include "support/support.h"

namespace mneme::test {
namespace {

const std::string kInputSource = "f";

using internal::Input;

Result<Problem> read(const std::string& yaml, const ProblemOptions& options = {}) {
  return internal::without_throwing([&] {
    const auto value = internal::parse_yaml("robot: planar8\n" + yaml, "f");
    const Input input(value, kInputSource);
    return internal::read_problem({input, input, "p", "", make_circle_scene("s", {{3, 4, 1}})},
                                  options);
  });
}

TEST_SUITE("unit") {
  TEST_CASE("one goal or several are read") {
    CHECK(read("start: [1]\ngoal: [2]").value().goals == std::vector<Configuration>{{2}});
    CHECK(read("start: [1]\ngoals: [[2], [3]]").value().goals ==
          std::vector<Configuration>{{2}, {3}});
  }

  TEST_CASE("start and goal of the options stand for those of the file") {
    ProblemOptions options;
    options.start = Configuration{5};
    options.goal = Configuration{6};
    const auto problem = read("goals: [[2], [3]]", options);
    REQUIRE(problem.has_value());
    CHECK(problem->start == Configuration{5});
    CHECK(problem->goals == std::vector<Configuration>{{6}});
  }

  TEST_CASE("counts, limits and NaN of start and goal are left to planning") {
    const auto problem = read("start: [1, .nan]\ngoal: [99]");
    REQUIRE(problem.has_value());
    CHECK(std::isnan(problem->start[1]));
  }

  TEST_CASE("starts and goals that are missing or no numbers are refused") {
    CHECK(read("goal: [1]").error().message == "f:1: expected the key start, which is missing");
    CHECK(read("start: [1]").error().message == "f:1: expected the key goal, which is missing");
    CHECK(read("start: [1, x]\ngoal: [1]").error().message ==
          "f:2: key start[1]: expected a number, got \"x\"");
    CHECK(read("start: 1\ngoal: [1]").error().message == "f:2: key start: expected a list, got 1");
    CHECK(read("start: [1]\ngoal: [[1]]").error().message ==
          "f:3: key goal[0]: expected a number, got a list of 1");
    CHECK(read("start: [1]\ngoals: []").error().message ==
          "f:3: key goals: expected at least one goal, got a list of 0");
    CHECK(read("start: [1]\ngoal: [1]\ngoals: [[1]]").error().message ==
          "f:4: key goals: expected either goal or goals, got both");
  }

  TEST_CASE("obstacles are moved from the frame to the root link") {
    const TemporaryDirectory directory;
    write_file(directory / "lifter.urdf", kLiftUrdf);
    ProblemOptions options;
    options.robot_path = directory / "lifter.urdf";
    const auto problem = read("frame: base\nstart: [0, 0, 0]\ngoal: [0, 0, 0]", options);
    REQUIRE_MESSAGE(problem.has_value(), (problem ? "" : problem.error().message));
    CHECK(problem->robot_path == options.robot_path);
    const auto sphere = std::get<Sphere>(problem->scene.obstacles[0].shapes[0]);
    CHECK((sphere.center - Vec3(-4, 3, 0.5)).norm() < 1e-12);
  }

  TEST_CASE("paths are relative to the directory of the file") {
    CHECK(internal::directory_of("a/b.yaml") == "a");
    CHECK(internal::directory_of("b.yaml").empty());
  }
}

}  // namespace
}  // namespace mneme::test
