// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/spheres.h"
#include "mneme/report.h"

#include "report/report_support.h"
#include "report/trace.h"
#include "report/traced_plan.h"
#include "support/support.h"

namespace mneme::internal {
namespace {

using test::require;

TEST_SUITE("unit") {
  TEST_CASE("The points of a planar arm are its joints and its end") {
    const Skeleton skeleton(test::unit_arm(3));
    const std::vector<Vec3> points = skeleton.points(Configuration{0, M_PI / 2, 0});
    const std::vector<Vec3> expected = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 2, 0}};
    REQUIRE(points.size() == expected.size());
    for (std::size_t i = 0; i < points.size(); ++i) CHECK((points[i] - expected[i]).norm() < 1e-12);
  }

  TEST_CASE("The tip of a gripper is between its fingers, whatever follows the last joint") {
    Robot::Parts parts;
    parts.name = "gripper";
    for (const char* name : {"base", "palm", "left", "right"})
      parts.links.emplace_back().name = name;
    const auto join = [&](int parent, int child, JointType type, const Vec3& offset) {
      Joint& joint = parts.joints.emplace_back();
      joint.name = "to_" + std::to_string(child);
      joint.type = type;
      joint.parent_link = parent;
      joint.child_link = child;
      joint.origin.translation = offset;
      joint.lower = -1;
      joint.upper = 1;
    };
    join(0, 1, JointType::revolute, Vec3(0, 0, 1));
    join(1, 2, JointType::fixed, Vec3(0.2, 0.05, 0));
    join(1, 3, JointType::fixed, Vec3(0.2, -0.05, 0));
    parts.links[1].spheres = {{Vec3(0.05, 0, 0), 0.04}};
    parts.links[2].spheres = {{Vec3::Zero(), 0.01}};
    parts.links[3].spheres = {{Vec3::Zero(), 0.01}};
    const auto robot = require(make_robot(std::move(parts)));
    const Configuration rest = {0};
    const Vec3 tip = Skeleton(robot).tip(robot.link_poses(rest));
    CHECK((tip - Vec3(0.2, 0, 1)).norm() < 1e-12);
  }
}

}  // namespace

}  // namespace mneme::internal

namespace mneme {
namespace {

using test::contains;
using test::require;
using test::require_error;

void draw(PlanRecorder& recorder, int count, SampleSource source) {
  for (int i = 0; i < count; ++i)
    recorder.on_sample(std::array{static_cast<float>(i), 0.0F}, source);
}

TEST_SUITE("unit") {
  TEST_CASE("What fits is kept whole, in order, with its source") {
    PlanRecorder recorder({.samples = 4, .edges = 4});
    draw(recorder, 3, kUniformSource);
    draw(recorder, 2, 7);
    recorder.on_edge(std::array{1.0F, 2.0F}, std::array{3.0F, 4.0F}, 1);
    REQUIRE(recorder.uniform_samples().entries().size() == 3);
    CHECK(recorder.uniform_samples().entries()[2].q == std::vector<float>{2, 0});
    REQUIRE(recorder.memory_samples().entries().size() == 2);
    CHECK(recorder.memory_samples().entries()[1].source == 7);
    CHECK(recorder.sample_counts() ==
          std::map<SampleSource, std::uint64_t>{{kUniformSource, 3}, {7, 2}});
    REQUIRE(recorder.edges().entries().size() == 1);
    CHECK(recorder.edges().entries()[0].graph == 1);
    CHECK(recorder.edges().entries()[0].from == std::vector<float>{1, 2});
    CHECK(recorder.edges().entries()[0].to == std::vector<float>{3, 4});
  }

  TEST_CASE("Uniform samples leave those from memory their room") {
    PlanRecorder recorder({.samples = 10});
    draw(recorder, 10000, kUniformSource);
    draw(recorder, 5, 0);
    CHECK(recorder.memory_samples().entries().size() == 5);
  }
}

TEST_SUITE("law") {
  TEST_CASE("A long run is thinned evenly: at least half the limit stays, at equal distances") {
    for (const int limit : {2, 3, 10, 300}) {
      for (const int count : {1, 2, 11, 299, 301, 5000, 65537}) {
        INFO("limit ", limit, ", count ", count);
        PlanRecorder recorder({.samples = limit});
        draw(recorder, count, kUniformSource);
        const auto& kept = recorder.uniform_samples().entries();
        CHECK(recorder.uniform_samples().seen() == static_cast<std::uint64_t>(count));
        CHECK(static_cast<int>(kept.size()) <= limit);
        CHECK(static_cast<int>(kept.size()) >= std::min(count, limit / 2));
        CHECK(kept[0].q[0] == 0);
        for (std::size_t i = 2; i < kept.size(); ++i)
          REQUIRE(kept[i].q[0] - kept[i - 1].q[0] == kept[1].q[0]);
      }
    }
  }
}

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
    CHECK(trace.primitives[0].sample_count == 1);
    CHECK(trace.component_count == 100);
    CHECK(trace.components.size() == 20);
    CHECK(trace.components[0].points.size() == 4);
    CHECK(trace.uniform_count == 3);
    REQUIRE(trace.samples.size() == 4);
    CHECK(trace.samples[3].source == 0);
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
    const auto trace = require(make_trace(plan.problem, plan.result, nullptr, 0));
    CHECK(trace.waypoints.empty());
    CHECK(trace.samples.empty());
    CHECK(trace.edges.empty());
    CHECK(trace.start.size() == 3);
    CHECK(trace.scene.obstacles.size() == 2);
  }

  TEST_CASE("A path of one place has waypoints") {
    test::TracedPlan plan;
    plan.result.plan.path = {plan.problem.start, plan.problem.start};
    CHECK(plan.trace().waypoints.size() == 2);
  }

  TEST_CASE("A plan that is refused for a contact says what touches, and where") {
    test::TracedPlan plan;
    plan.result.plan.path.clear();
    plan.problem.start = {std::atan2(1, 2), 0, 0};  // through the middle of the first circle
    plan.result.plan.status = PlanStatus::invalid_start;
    const auto trace = require(make_trace(plan.problem, plan.result, nullptr, 0));
    REQUIRE(trace.touches.size() >= 2);
    for (const PlanTrace::Touch& touch : trace.touches) {
      CHECK(touch.goal == -1);
      CHECK(touch.other == 0);
      CHECK_FALSE(touch.is_self);
      CHECK(touch.distance < 0);
      CHECK((touch.place - Vec3(2, 1, 0)).norm() < 1.3);
    }
    plan.result.plan.status = PlanStatus::invalid_goal;
    plan.problem.goals = {{0, 0, 0}, plan.problem.start};
    const auto of_goal = require(make_trace(plan.problem, plan.result, nullptr, 0));
    REQUIRE_FALSE(of_goal.touches.empty());
    CHECK(of_goal.touches[0].goal == 1);
    plan.result.plan.status = PlanStatus::timeout;
    CHECK(make_trace(plan.problem, plan.result, nullptr, 0)->touches.empty());
  }

  TEST_CASE("A plan in time has waypoints at equal times, with its limits") {
    const test::TracedPlan plan;
    const Path& path = plan.result.plan.path;
    const auto limits = require(find_rate_limits(plan.problem.robot));
    const auto trajectory = require(parameterize(plan.problem.robot, path, limits, {}, nullptr));
    const auto trace = require(make_trace(plan.problem, plan.result, nullptr, 0, {.waypoints = 40},
                                          {&trajectory, &limits}));
    CHECK(trace.duration_s == trajectory.duration_s());
    REQUIRE(trace.waypoints.size() == 41);
    for (std::size_t i = 0; i < 41; ++i) {
      const PlanTrace::Waypoint& waypoint = trace.waypoints[i];
      CHECK(std::abs(waypoint.time_s - trajectory.duration_s() * static_cast<double>(i) / 40) <
            1e-12);
      CHECK(waypoint.q == trajectory.at(waypoint.time_s).position);
      CHECK(waypoint.velocity == trajectory.at(waypoint.time_s).velocity);
      CHECK(waypoint.acceleration.size() == 3);
    }
    REQUIRE(trace.vertices.size() == path.size());
    CHECK(trace.vertices.front() == 0);
    CHECK(trace.vertices.back() == 40);
    CHECK(trace.limits.velocity == limits.velocity);
    CHECK(trace.limits.acceleration == limits.acceleration);
    CHECK(std::isinf(trace.limits.upper[0]));  // a continuous joint
    CHECK(trace.limits.upper[1] == 3.14159);
  }

  TEST_CASE("What a link carries is seen as what it is, under its own name") {
    test::TracedPlan plan;
    const auto carrying =
        attach(plan.problem.robot,
               {{.name = "box", .link = "link_3", .shapes = {Box{{}, {0.1, 0.1, 0.1}}}}});
    REQUIRE(carrying.has_value());
    plan.problem.robot = *carrying;
    const PlanTrace trace = plan.trace();
    REQUIRE(trace.links.size() == 4);
    CHECK(trace.links[3].name == "box");
    CHECK(trace.carriers[3] == "link_3");
    CHECK(trace.carriers[0].empty());
    REQUIRE(trace.looks[3].size() == 1);
    CHECK(std::holds_alternative<Box>(trace.looks[3][0].shape));
    CHECK(trace.start.size() == 4);
  }

  TEST_CASE("What does not fit the robot is an error that says what") {
    const auto message = [](auto&& change) {
      test::TracedPlan plan;
      change(plan);
      const Error error = require_error(make_trace(plan.problem, plan.result, nullptr, 0));
      CHECK(error.code == ErrorCode::invalid);
      return error.message;
    };
    CHECK(
        contains(message([](auto& p) { p.problem.start = {1}; }), "the start has 1 values; robot"));
    CHECK(contains(message([](auto& p) { p.problem.goals[0][1] = NAN; }), "a goal has a value"));
    CHECK(contains(message([](auto& p) { p.result.plan.path[1].pop_back(); }), "a waypoint has 2"));
    CHECK(contains(message([](auto& p) {
                     p.result.gl.primitives[0].primitive.obstacles = {0, 9};
                   }),
                   "another scene"));
  }
}

}  // namespace

}  // namespace mneme
