// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/small_robots.h"
#include "support/support.h"

namespace mneme::test {
namespace {

/// The lifter's arm is a ball of 0.1 m about [0, 0, 0.5] of the root at its start. Of the points,
/// in the order of their distance from it, two are in it, one is 5 mm from it, one far.
std::string problem_with(const std::string& keys, const std::string& obstacles = "") {
  return "robot: ./lifter.urdf\njoints: [lift, turn]\nstart: [0, 0]\ngoal: [1, 1]\n"
         "scene:\n  obstacles:\n"
         "    - {name: cloud, type: points, radius: 0.01, position: [0, 0, 0.5],\n"
         "       points: [0, 0, 0, 0, 0.105, 0, 0.115, 0, 0, 0, 0, 3]}\n" +
         obstacles + keys;
}

Result<Problem> load(const std::string& text, const ProblemOptions& options = {}) {
  const TemporaryDirectory directory;
  write_file(directory / "lifter.urdf", kLiftUrdf);
  write_file(directory / "p.yaml", text);
  return load_problem(directory / "p.yaml", options);
}

Problem require_problem(const std::string& text, const ProblemOptions& options = {}) {
  return require(load(text, options));
}

std::size_t points_in(const Scene& scene) {
  const auto* cloud = std::get_if<PointCloud>(&scene.obstacles.at(0).shapes.at(0));
  REQUIRE(cloud != nullptr);
  return cloud->parts->list().size();
}

TEST_SUITE("unit") {
  TEST_CASE("points of the robot itself stay unless their distance is asked for") {
    const Problem all = require_problem(problem_with(""));
    CHECK(points_in(all.scene) == 4);
    CHECK(all.warnings.empty());
    const Problem touching = require_problem(problem_with("self_filter: 0\n"));
    CHECK(points_in(touching.scene) == 2);
    CHECK(touching.warnings ==
          std::vector<std::string>{"obstacle cloud: 2 of 4 points are nearer than 0 m to the "
                                   "robot's spheres and ignored"});
    CHECK(points_in(require_problem(problem_with("self_filter: 0.004\n")).scene) == 2);
    CHECK(points_in(require_problem(problem_with("self_filter: 0.006\n")).scene) == 1);
  }

  TEST_CASE("the distance of the options stands for that of the problem") {
    ProblemOptions options;
    options.self_filter = 0.006;
    CHECK(points_in(require_problem(problem_with("self_filter: 0\n"), options).scene) == 1);
    CHECK(points_in(require_problem(problem_with(""), options).scene) == 1);
    options.self_filter = 0.0;
    options.start = Configuration{1, 0};
    CHECK(points_in(require_problem(problem_with(""), options).scene) == 4);
  }

  TEST_CASE("what the robot carries counts, too") {
    const std::string keys =
        "attached: [{name: tool, link: arm, type: sphere, position: [0, 0, 3], radius: 0.1}]\n"
        "self_filter: 0\n";
    CHECK(points_in(require_problem(problem_with(keys)).scene) == 1);
  }

  TEST_CASE("other obstacles stay, and a cloud without points left goes") {
    const std::string ball = "    - {name: ball, type: sphere, position: [2, 0, 0], radius: 0.1}\n";
    const Problem problem = require_problem(problem_with("self_filter: 10\n", ball));
    REQUIRE(problem.scene.obstacles.size() == 1);
    CHECK(problem.scene.obstacles[0].name == "ball");
  }

  TEST_CASE("the filter of a large cloud can be interrupted, and the scene stays as it was") {
    const Problem problem = require_problem(problem_with(""));
    Scene scene;
    std::vector<CloudPoint> points(2000, CloudPoint{0, 0, 3});
    points.front() = {0, 0, 0.5};
    Obstacle& cloud = scene.obstacles.emplace_back();
    cloud.name = "cloud";
    cloud.shapes = {PointCloud{{}, std::make_shared<Parts<CloudPoint>>(points), 0.01}};
    for (const int most : {0, 3}) {
      int polls = 0;
      const InterruptScope scope([&] { return ++polls > most; });
      CHECK_THROWS_AS((void)drop_own_points(scene, problem.robot, problem.start, 0), Interrupted);
      CHECK(points_in(scene) == 2000);
    }
    require(drop_own_points(scene, problem.robot, problem.start, 0));
    CHECK(points_in(scene) == 1999);
  }

  TEST_CASE("points of a scene that others hold stay theirs") {
    Problem problem = require_problem(problem_with(""));
    const Scene before = problem.scene;
    CHECK(require(drop_own_points(problem.scene, problem.robot, problem.start, 0)).size() == 1);
    CHECK(points_in(before) == 4);
    CHECK(points_in(problem.scene) == 2);
    CHECK(require(drop_own_points(problem.scene, problem.robot, problem.start, 0)).empty());
  }

  TEST_CASE("a distance below 0 is refused with line and key, and as an option") {
    CHECK(require_error(load(problem_with("self_filter: -1\n")))
              .message.ends_with("p.yaml:9: key self_filter: expected 0 or more metres, got -1"));
    CHECK_FALSE(load(problem_with("self_filter: .nan\n")).has_value());
    ProblemOptions options;
    options.self_filter = -1;
    CHECK(require_error(load(problem_with(""), options)).message ==
          "self_filter: expected 0 or more metres, got -1");
    Problem other = require_problem(problem_with(""));
    CHECK_FALSE(drop_own_points(other.scene, other.robot, Configuration{0}, 0).has_value());
  }

  TEST_CASE("a start beyond the limits drops nothing: planning refuses it") {
    ProblemOptions options;
    options.start = Configuration{9, 0};
    CHECK(points_in(require_problem(problem_with("self_filter: 0\n"), options).scene) == 4);
  }
}

}  // namespace
}  // namespace mneme::test
