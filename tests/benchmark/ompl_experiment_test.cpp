// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmark/ompl_experiment.h"

#include "benchmark/bench_support.h"

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
