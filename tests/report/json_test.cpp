// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/report.h"

#include "report/report_support.h"
#include "report/traced_plan.h"

#include <nlohmann/json.hpp>

namespace mneme {
namespace {

SolveResult solved_result() {
  SolveResult result;
  result.plan.status = PlanStatus::solved;
  result.plan.path = {{0, 0, 0}, {0.3, 0.4, 0}};
  result.plan.iterations = 7;
  result.plan.states_checked = 100;
  result.plan.motions_checked = 12;
  result.plan.simplification_time_s = 0.5;
  result.plan.verification_time_s = 0.75;
  result.gl = test::gap_memory(5);
  result.total_time_s = 2;
  result.planning_time_s = 1;
  result.planner = "rrt_connect";
  result.sampler = "gl";
  result.seed = 18446744073709551615ULL;
  return result;
}

TEST_SUITE("unit") {
  TEST_CASE("JSON of a solved problem holds every documented key with its value") {
    const auto json = nlohmann::json::parse(to_json(test::gap_problem(), solved_result(), 0.0625));
    const nlohmann::json expected = {{"problem", "gap"},
                                     {"robot", "unit_arm"},
                                     {"status", to_string(PlanStatus::solved)},
                                     {"solved", true},
                                     {"path", {{0.0, 0.0, 0.0}, {0.3, 0.4, 0.0}}},
                                     {"path_length", json.at("path_length")},
                                     {"straight_length", json.at("straight_length")},
                                     {"total_time_s", 2.0},
                                     {"preparation_time_s", 0.0},
                                     {"planning_time_s", 1.0},
                                     {"retrieval_time_s", 0.25},
                                     {"learning_time_s", 0.125},
                                     {"simplification_time_s", 0.5},
                                     {"verification_time_s", 0.75},
                                     {"goal_time_s", 0.0},
                                     {"improvement_time_s", 0.0},
                                     {"remembering_time_s", 0.0},
                                     {"load_time_s", 0.0625},
                                     {"iterations", 7},
                                     {"states_checked", 100},
                                     {"motions_checked", 12},
                                     {"remembered", 0},
                                     {"replayed", false},
                                     {"primitives", 1},
                                     {"retrieved", 2},
                                     {"components", 5},
                                     {"sampler", "gl"},
                                     {"planner", "rrt_connect"},
                                     {"seed", 18446744073709551615ULL},
                                     {"isa", to_string(Isa::scalar)}};
    CHECK(json == expected);
    CHECK(json.at("path_length").get<double>() == doctest::Approx(0.5));
  }

  TEST_CASE("the measures of a path are its length, that of its ends, and where it is nearest") {
    Problem problem = test::gap_problem();
    const Path path = {{0, 0, 0}, {0.6, 0, 0}, {0.3, 0.4, 0}};
    problem.scene = make_circle_scene("one", {{2.0, 2.0, 0.1}, {2.5, 2.5, 0.1}});
    const PathMeasures measures = measure_path(problem.robot, problem.scene, path);
    CHECK(measures.length == doctest::Approx(0.6 + 0.5));
    CHECK(measures.straight == doctest::Approx(0.5));
    REQUIRE(measures.clearance.has_value());
    CHECK(measures.clearance->obstacle == "circle_1");
    // No state of a hundred between is nearer by more than the refined step allows.
    double least = 1e9;
    for (const Configuration& q : {path[0], path[1], path[2]}) {
      const PathMeasures one = measure_path(problem.robot, problem.scene, {q});
      least = std::min(least, one.clearance->distance);
    }
    CHECK(measures.clearance->distance <= least);
    CHECK(measures.clearance->distance > 0);

    const auto json = nlohmann::json::parse(to_json(problem, solved_result(), 0, &measures));
    CHECK(json.at("least_clearance") == measures.clearance->distance);
    CHECK(json.at("nearest_link") == measures.clearance->link);
    CHECK(json.at("nearest_obstacle") == "circle_1");
    problem.scene.obstacles.clear();
    CHECK_FALSE(measure_path(problem.robot, problem.scene, path).clearance.has_value());
    CHECK(measure_path(problem.robot, problem.scene, {}).length == 0);
  }

  TEST_CASE("the least clearance is found on either side of a waypoint and at every near passage") {
    Problem problem = test::gap_problem();
    // The arm is straight; its tip passes the circles' centres at these angles.
    const double radius = 0.1;
    const auto circle_at = [&](double angle, double from_base) {
      return std::array{from_base * std::cos(angle), from_base * std::sin(angle), radius};
    };
    const double reach = 3;
    problem.scene =
        make_circle_scene("two", {circle_at(0.305, reach + 0.12), circle_at(0.813, reach + 0.117)});
    const double nearest = 0.117 - radius - 0.001;
    const auto least_of = [&](const Path& path) {
      return measure_path(problem.robot, problem.scene, path).clearance->distance;
    };
    // Waypoints just before and just behind the nearest place, and none near it.
    for (const double waypoint : {0.808, 0.818, 0.5}) {
      CAPTURE(waypoint);
      const Path path = {{0, 0, 0}, {waypoint, 0, 0}, {1.5, 0, 0}};
      CHECK(least_of(path) == doctest::Approx(nearest).epsilon(1e-3));
      CHECK(least_of({path[2], path[1], path[0]}) == doctest::Approx(nearest).epsilon(1e-3));
    }
  }

  TEST_CASE("JSON of a plan has the measures of its motion, if there is one") {
    const Problem problem = test::gap_problem();
    const MotionMeasures motion{1.5, 8, {1, 0.5}, {2, 1}, {4, 2}};
    const auto json = nlohmann::json::parse(to_json(problem, solved_result(), 0, nullptr, &motion));
    CHECK(json.at("duration_s") == 1.5);
    CHECK(json.at("motion").at("greatest_acceleration") == std::vector<double>{2, 1});
    CHECK(json.at("motion").at("jerk_integral") == 8);
    CHECK_FALSE(nlohmann::json::parse(to_json(problem, solved_result(), 0)).contains("motion"));
  }

  TEST_CASE("JSON of a failure says why, and has an empty path") {
    SolveResult result;
    result.plan.status = PlanStatus::invalid_start;
    result.plan.message = "start: link_2 touches circle_1";
    const auto json = nlohmann::json::parse(to_json(test::gap_problem(), result, 0));
    CHECK(json.at("solved") == false);
    CHECK(json.at("status") == to_string(PlanStatus::invalid_start));
    CHECK(json.at("message") == result.plan.message);
    CHECK(json.at("path").empty());
    CHECK(json.at("path").is_array());
    CHECK(json.at("components") == 0);
  }

  TEST_CASE("JSON says why a path could not be remembered") {
    SolveResult result = solved_result();
    result.remembered.failure = "disk full";
    const auto json = nlohmann::json::parse(to_json(test::gap_problem(), result, 0));
    CHECK(json.at("remembered") == 0);
    CHECK(json.at("remember_failure") == "disk full");
  }

  TEST_CASE("JSON says whether a known task was replayed, and what was in the way of it") {
    Problem problem = test::gap_problem();
    problem.scene = make_circle_scene("one", {{0.5, 0, 0.1}});
    SolveResult result = solved_result();
    result.replay.time_s = 0.5;
    const auto text = [&] { return to_json(problem, result, 0); };
    const auto replay = [&] { return nlohmann::json::parse(text()).at("replay"); };
    CHECK(replay().at("explanation") == "not replayed: no task is known");
    result.replay.nearest = 0.4;
    CHECK(replay().at("explanation") == "not replayed: the nearest known task is 0.400 rad away");
    CHECK(replay().at("nearest") == 0.4);
    result.replay.nearest.reset();
    result.replay.blocked = {{7, 0.25, 0.62, {0, 0, 0}}};
    CHECK(replay().at("blocked").at(0).at("obstacle") == "circle_1");
    CHECK(replay().at("blocked").at(0).at("row") == 7);
    CHECK(replay().at("explanation") ==
          "not replayed: row 7, 0.250 rad away, is blocked at 62 %: link '" +
              replay().at("blocked").at(0).at("link").get<std::string>() +
              "' touches obstacle 'circle_1'");
    result.replay.row = 7;
    result.replay.distance = 0.25;
    result.replay.is_repaired = true;
    CHECK(nlohmann::json::parse(text()).at("replayed") == true);
    CHECK(replay().at("explanation").get<std::string>().starts_with("repaired row 7, 0.250 rad"));
    result.replay.is_repaired = false;
    CHECK(replay().at("explanation") == "replayed row 7, 0.250 rad away");
    CHECK(replay().at("distance") == 0.25);
  }

  TEST_CASE("JSON survives names that are not UTF-8") {
    Problem problem = test::gap_problem();
    problem.name = "bad \xFF \"name\"\n";
    const auto json = nlohmann::json::parse(to_json(problem, solved_result(), 0));
    CHECK(json.at("problem") == "bad \xEF\xBF\xBD \"name\"\n");
  }
}

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
