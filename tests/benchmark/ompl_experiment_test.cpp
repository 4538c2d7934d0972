// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmark/bench_support.h"
#include "benchmark/ompl_experiment.h"

#include <sstream>

namespace mneme::internal {
namespace {

TEST_SUITE("unit") {
  TEST_CASE("A problem is an experiment, a planner with sampler and setting a configuration") {
    const auto experiments = to_experiments(test::suite_rows());
    REQUIRE(experiments.size() == 1);
    CHECK(experiments[0].name == "scenario_S1");
    CHECK(experiments[0].timeout_s == 20);
    CHECK(experiments[0].run_count == 20);
    CHECK(experiments[0].date == "2026-01-31 12:00:00");
    REQUIRE(experiments[0].planners.size() == 9);
    const OmplPlanner& planner = experiments[0].planners[0];
    CHECK(planner.name == "rrt_connect_gl_tuned");
    CHECK(planner.settings ==
          std::vector<std::string>{"sampler = gl", "timeout = 20", "range = 0.5", "memory = grid"});
    REQUIRE(planner.runs.size() == 20);
    CHECK(planner.runs[0].size() == kOmplProperties.size());
  }

  TEST_CASE("Failures stand at the limit, and a path that did not survive is one") {
    std::vector<BenchmarkRow> rows = {test::run(0.5), test::run(0.5), test::run(3, false)};
    for (BenchmarkRow& row : rows) row.timeout_s = 3;
    rows[1].is_path_valid = false;
    const auto runs = to_experiments(rows)[0].planners[0].runs;
    REQUIRE(runs.size() == 3);
    CHECK(runs[0][0] == "1");
    CHECK(runs[0][2] == "0.5");
    CHECK(runs[0][5] == "6");
    for (const std::size_t i : {1, 2}) {
      CHECK(runs[i][0] == "0");
      CHECK(runs[i][2] == "3");
      CHECK(runs[i][4].empty());
      CHECK(runs[i][5] == "4");
    }
  }
}

}  // namespace

}  // namespace mneme::internal

namespace mneme {
namespace {

TEST_SUITE("unit") {
  TEST_CASE("A log has OMPL's head, and for each planner as many lines as it announces") {
    const auto logs = to_ompl_logs(test::suite_rows());
    REQUIRE(logs.size() == 1);
    CHECK(logs[0].experiment == "scenario_S1");
    std::istringstream lines(logs[0].text);
    std::string line;
    std::getline(lines, line);
    CHECK(line == "mneme version " + std::string(version()));
    std::getline(lines, line);
    CHECK(line == "Experiment scenario_S1");
    int planners = 0, runs = 0;
    while (std::getline(lines, line)) {
      planners += line == "." ? 1 : 0;
      runs += line.ends_with("; ") ? 1 : 0;
    }
    CHECK(planners == 9);
    CHECK(runs == 180);
  }

  TEST_CASE("Blanks and line breaks in names cannot break the format") {
    std::vector<BenchmarkRow> rows = {test::run(1)};
    rows[0].set = "a b\nc";
    rows[0].setting = "x\ny";
    const auto logs = to_ompl_logs(rows);
    CHECK(logs[0].experiment == "a_b_c_S1");
    CHECK(logs[0].text.find("\nrrt_connect_gl_x_y\n") != std::string::npos);
  }
}

}  // namespace

}  // namespace mneme
