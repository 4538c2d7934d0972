// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/report.h"

#include "report/traced_plan.h"

#include <nlohmann/json.hpp>

namespace mneme {
namespace {

using Json = nlohmann::json;

TEST_SUITE("unit") {
  TEST_CASE("The JSON of a trace has format, version and every documented part") {
    const Json json = Json::parse(to_json(test::TracedPlan().trace()));
    CHECK(json.at("format") == "mneme-trace");
    CHECK(json.at("version") == 1);
    CHECK(json.at("problem") == "gap");
    CHECK(json.at("robot") == "unit_arm");
    CHECK(json.at("is_planar") == true);
    CHECK(json.at("joints") == Json({"joint_1", "joint_2", "joint_3"}));
    CHECK(json.at("plan").at("status") == "solved");
    CHECK(json.at("times").at("load_time_s") == 0.25);
    CHECK(json.at("links")[2].at("capsules")[0] == Json({0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.001}));
    CHECK(json.at("obstacles")[0].at("shapes")[0] ==
          Json({{"type", "sphere"}, {"sphere", {2.0, 1.0, 0.0, 0.7}}}));
    const Json& waypoint = json.at("waypoints")[0];
    CHECK(waypoint.at("q").size() == 3);
    CHECK(waypoint.at("poses")[1] == Json({1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0}));
    CHECK(waypoint.at("nearest") == Json({1, 0}));
    CHECK(waypoint.at("clearance") == 0.299);
    CHECK(json.at("primitives")[0].at("similarity_errors") == Json({0.01235, 0.2}));
    CHECK(json.at("components").at("count") == 5);
    CHECK(json.at("samples").at("shown")[0].at("points").size() == 12);
    CHECK(json.at("edges").at("shown")[0].at("tips").size() == 9);
  }

  TEST_CASE("Every shape is written with its sizes") {
    test::TracedPlan plan;
    Box box;
    box.half_extents = Vec3(1, 2, 3);
    Cylinder cylinder;
    cylinder.radius = 0.5;
    cylinder.length = 4;
    plan.problem.scene.obstacles = {
        {"all", {box, cylinder, Capsule{Vec3::Zero(), Vec3(0, 0, 1), 0.1}}},
        {"far", {Sphere{Vec3(9, 9, 9), 1}}}};
    const Json json = Json::parse(to_json(plan.trace()));
    const Json& shapes = json.at("obstacles")[0].at("shapes");
    CHECK(shapes[0].at("size") == Json({2.0, 4.0, 6.0}));
    CHECK(shapes[1].at("radius") == 0.5);
    CHECK(shapes[1].at("length") == 4.0);
    CHECK(shapes[2].at("capsule") == Json({0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.1}));
  }

  TEST_CASE("Without obstacles there is no clearance, and names may hold any bytes") {
    test::TracedPlan plan;
    plan.problem.scene.obstacles.clear();
    plan.result.gl = {};
    plan.problem.name = "bad \xFF";
    const Json json = Json::parse(to_json(plan.trace()));
    CHECK(json.at("waypoints")[0].at("clearance").is_null());
    CHECK(json.at("problem") == "bad \xEF\xBF\xBD");
  }

  TEST_CASE("A trace is bounded, however long the search was") {
    test::TracedPlan plan(5000);
    for (int i = 0; i < 200000; ++i) {
      const std::array<float, 3> q = {0.001F * static_cast<float>(i % 3000), 0.1F, 0.2F};
      plan.recorder.on_sample(q, i % 3 - 1);
      plan.recorder.on_edge(q, std::array{3.0F, 3.0F, 3.0F}, i % 2);
    }
    CHECK(to_json(plan.trace()).size() < 700000);
  }
}

}  // namespace
}  // namespace mneme
