// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/report.h"

#include "report/traced_plan.h"

namespace mneme {
namespace {

TEST_SUITE("unit") {
  TEST_CASE(
      "Waypoints go from start to goal in small steps and stop at the path's configurations") {
    const test::TracedPlan plan;
    const PlanTrace trace = plan.trace({.waypoints = 50});
    REQUIRE(trace.vertices.size() == 3);
    CHECK(trace.vertices.front() == 0);
    CHECK(trace.vertices.back() == static_cast<int>(trace.waypoints.size()) - 1);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto at = static_cast<std::size_t>(trace.vertices[i]);
      CHECK(trace.waypoints[at].q == plan.result.plan.path[i]);
    }
    const double step = trace.path_length / 50;
    for (std::size_t i = 1; i < trace.waypoints.size(); ++i) {
      const PlanTrace::Waypoint& before = trace.waypoints[i - 1];
      const PlanTrace::Waypoint& here = trace.waypoints[i];
      const double moved = plan.problem.robot.distance(before.q, here.q);
      CHECK(moved <= step + 1e-12);
      CHECK(here.travelled - before.travelled == doctest::Approx(moved));
    }
    CHECK(trace.waypoints.size() <= 53);
  }

  TEST_CASE("Poses are of the links that have shapes, and the tip is the end of the last one") {
    const test::TracedPlan plan;
    const PlanTrace trace = plan.trace();
    REQUIRE(trace.links.size() == 3);
    CHECK(trace.links[0].name == "link_1");
    CHECK(trace.is_planar);
    for (const PlanTrace::Waypoint& waypoint : trace.waypoints) {
      REQUIRE(waypoint.poses.size() == 3);
      CHECK((waypoint.poses[2] * Vec3(1, 0, 0) - waypoint.tip).norm() < 1e-12);
    }
    CHECK((trace.waypoints[0].tip - Vec3(3, 0, 0)).norm() < 1e-12);
    CHECK(trace.waypoints[0].clearance == doctest::Approx(0.3 - 0.001));
    CHECK(trace.links[static_cast<std::size_t>(trace.waypoints[0].nearest_link)].name == "link_2");
    CHECK(trace.waypoints[0].nearest_obstacle == 0);
    CHECK(trace.goals.size() == 1);
  }

  TEST_CASE("Memory and search come with their sources and whole counts") {
    const test::TracedPlan plan(100);
    const PlanTrace trace = plan.trace({.components = 20});
    REQUIRE(trace.primitives.size() == 1);
    CHECK(trace.primitives[0].similarity_errors == std::vector<double>{0.0123456, 0.2});
    CHECK(trace.primitives[0].components == 4);
    CHECK(trace.primitives[0].draws == 1);
    CHECK(trace.component_count == 100);
    CHECK(trace.components.size() == 20);
    CHECK(trace.components[0].points.size() == 4);
    CHECK(trace.uniform_draws == 3);
    REQUIRE(trace.samples.size() == 4);
    CHECK(trace.samples[3].origin == 0);
    CHECK((trace.samples[3].points.back() - 3 * Vec3(std::cos(0.3F), std::sin(0.3F), 0)).norm() <
          1e-6);
    CHECK(trace.edge_count == 2);
    REQUIRE(trace.edges.size() == 2);
    CHECK(trace.edges[1].graph == 1);
    CHECK(trace.edges[0].tips.size() == 3);  // half a radian is more than one step
    CHECK(trace.edges[1].tips.size() == 2);
  }

  TEST_CASE("Without a path and a recorder there are start, goals and scene") {
    test::TracedPlan plan;
    plan.result.plan.path.clear();
    plan.result.plan.status = PlanStatus::timeout;
    const auto trace = make_trace(plan.problem, plan.result, nullptr, 0);
    REQUIRE(trace.has_value());
    CHECK(trace->waypoints.empty());
    CHECK(trace->samples.empty());
    CHECK(trace->edges.empty());
    CHECK(trace->start.size() == 3);
    CHECK(trace->scene.obstacles.size() == 2);
  }

  TEST_CASE("A path of one place has waypoints") {
    test::TracedPlan plan;
    plan.result.plan.path = {plan.problem.start, plan.problem.start};
    CHECK(plan.trace().waypoints.size() == 2);
  }

  TEST_CASE("What does not fit the robot is an error that says what") {
    const auto message = [](auto&& change) {
      test::TracedPlan plan;
      change(plan);
      const auto trace = make_trace(plan.problem, plan.result, nullptr, 0);
      REQUIRE_FALSE(trace.has_value());
      CHECK(trace.error().code == ErrorCode::invalid);
      return trace.error().message;
    };
    const auto has = [](const std::string& text, const char* part) {
      return text.find(part) != std::string::npos;
    };
    CHECK(has(message([](auto& p) { p.problem.start = {1}; }), "start has 1 values, expected 3"));
    CHECK(has(message([](auto& p) { p.problem.goals[0][1] = NAN; }), "goal holds a value"));
    CHECK(has(message([](auto& p) { p.result.plan.path[1].pop_back(); }), "of the path has 2"));
    CHECK(has(message([](auto& p) {
                p.result.gl.primitives[0].primitive.obstacles = {0, 9};
              }),
              "another scene"));
  }
}

}  // namespace
}  // namespace mneme
