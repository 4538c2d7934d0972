// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/live.h"
#include "mneme/pipeline.h"

#include "support/support.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace mneme::test {
namespace {

/// The text of the element `id` of a page.
std::string element_of(const std::string& page, const std::string& id) {
  const std::size_t begin = page.find("id=\"" + id + "\">");
  REQUIRE(begin != page.npos);
  const std::size_t from = page.find('>', begin) + 1;
  return page.substr(from, page.find("</script>", from) - from);
}

/// The problem that the planner in the page opens; its files are below `directory` here.
Problem problem_in(const std::string& page, const std::string& directory) {
  const auto trace = nlohmann::json::parse(element_of(page, "trace"));
  const auto& planner = trace["live"]["planner"];
  for (const auto& file : planner["files"]) {
    std::string text = file["text"];
    if (const auto at = text.find("\"/robot.urdf\""); at != text.npos) {
      text.insert(at + 1, directory);
    }
    test::write_file(directory + file["path"].get<std::string>(), text);
  }
  auto problem = load_problem(directory + planner["problem"].get<std::string>());
  REQUIRE_MESSAGE(problem.has_value(), problem.error().message);
  return *std::move(problem);
}

Path plan(const Problem& problem) {
  const SolveResult result = require_solved(problem, nullptr, {});
  return result.plan.path;
}

}  // namespace

TEST_SUITE("flow") {
  TEST_CASE("a page that plans by itself holds a problem with the same plan") {
    const TemporaryDirectory directory;
    for (const char* name : {"shelf/thick.yaml", "planar/scenario1.yaml"}) {
      CAPTURE(name);
      const Problem problem = load_problem(find_scene(name).value()).value();
      const auto page = require(make_offline_page(problem, {"script", "module"}));
      const Problem read = problem_in(page, directory / "");
      CHECK(std::ranges::equal(read.robot.self_pairs(), problem.robot.self_pairs()));
      CHECK(read.robot.joint_names() == problem.robot.joint_names());
      CHECK(plan(read) == plan(problem));
    }
  }

  TEST_CASE("an attached mesh, which the page could not read, is refused by name") {
    Problem problem = load_problem(find_scene("shelf/thick.yaml").value()).value();
    AttachedObject part{.name = "part", .link = "gripper_link"};
    part.meshes.push_back({"part.stl", Vec3::Ones(), Transform()});
    ApproximatedObject carried{.object = part, .spheres = {{{0, 0, 0}, 0.01}}};
    problem.robot = problem.robot.with_attached({carried}).value();
    const Error error = require_error(make_offline_page(problem, {"script", "module"}));
    CHECK(error.code == ErrorCode::unsupported);
    CHECK(contains(error.message, "'part'"));
  }

  TEST_CASE("the bytes of the module stand in the page, and no link to another file") {
    const Robot robot = load_robot(find_robot("panda").value()).value();
    const auto page = require(make_offline_page(resting_problem(robot, ""), {"script", "module"}));
    CHECK(element_of(page, "planner-code") == "c2NyaXB0");
    CHECK(element_of(page, "planner-wasm") == "bW9kdWxl");
    CHECK(page.find(" src=") == page.npos);
  }

  TEST_CASE("the page of a service has no planner, and keeps clouds for the service") {
    const Robot robot = load_robot(find_robot("panda").value()).value();
    Problem problem = resting_problem(robot, "");
    const std::vector<CloudPoint> points = {{2, 0, 0}};
    CHECK(robot.describe_violation(problem.start, "start") == std::nullopt);
    problem.scene.obstacles.push_back(
        {"scan", {PointCloud{{}, std::make_shared<Parts<CloudPoint>>(points), 0.01}}});
    problem.scene.obstacles.push_back({"ball", {Sphere{{2, 0, 0}, 0.1}}});
    const auto page = require(make_live_page(problem, true));
    REQUIRE(page.kept.obstacles.size() == 1);
    CHECK(page.kept.obstacles[0].name == "scan");
    const auto trace = nlohmann::json::parse(element_of(page.html, "trace"));
    CHECK(trace["live"]["scene"] == kLivePageScene);
    CHECK(trace["live"]["has_memory"] == true);
    CHECK_FALSE(trace["live"].contains("planner"));
    CHECK(page.html.find("planner-wasm\">") == page.html.npos);
  }

  TEST_CASE("a page holds the constraints and the velocity at the start, for its requests") {
    Problem problem = load_problem(find_scene("shelf/thick.yaml").value()).value();
    problem.constraints = {{.link = "gripper_link", .axis = {1, 0, 0}, .angle = 0.5}};
    problem.start_velocity.assign(problem.start.size(), 0.0);
    problem.start_velocity[1] = 0.01;
    const auto constraint = nlohmann::json::parse(
        R"([{"link": "gripper_link", "axis": [1, 0, 0], "up": [0, 0, 1], "angle": 0.5}])");
    for (const std::string& html : {require(make_live_page(problem, false)).html,
                                    require(make_offline_page(problem, {"script", "module"}))}) {
      const auto live = nlohmann::json::parse(element_of(html, "trace"))["live"];
      CHECK(live["constraints"] == constraint);
      CHECK(live["start_velocity"] == problem.start_velocity);
    }
  }
}

}  // namespace mneme::test
