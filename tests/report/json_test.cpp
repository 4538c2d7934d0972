// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/report.h"

#include "report/report_support.h"

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
                                     {"total_time_s", 2.0},
                                     {"planning_time_s", 1.0},
                                     {"retrieval_time_s", 0.25},
                                     {"learning_time_s", 0.125},
                                     {"simplification_time_s", 0.5},
                                     {"verification_time_s", 0.75},
                                     {"remembering_time_s", 0.0},
                                     {"load_time_s", 0.0625},
                                     {"iterations", 7},
                                     {"states_checked", 100},
                                     {"motions_checked", 12},
                                     {"remembered", 0},
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

  TEST_CASE("JSON survives names that are not UTF-8") {
    Problem problem = test::gap_problem();
    problem.name = "bad \xFF \"name\"\n";
    const auto json = nlohmann::json::parse(to_json(problem, solved_result(), 0));
    CHECK(json.at("problem") == "bad \xEF\xBF\xBD \"name\"\n");
  }
}

}  // namespace
}  // namespace mneme
