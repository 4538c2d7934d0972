// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmark/bench_support.h"

#include <sstream>

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
