// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmark/panels.h"

#include "benchmark/bench_support.h"

namespace mneme::internal {
namespace {

TEST_SUITE("unit") {
  TEST_CASE("Runs of a set are a panel, with a series per planner, sampler and setting") {
    auto rows = test::suite_rows();
    rows.push_back(rows[0]);
    rows.back().setting = "paper";
    rows.push_back(rows[0]);
    rows.back().set = "other";
    const auto panels = make_panels(rows, false);
    REQUIRE(panels.size() == 2);
    CHECK(panels[0].name == "scenario");
    REQUIRE(panels[0].series.size() == 10);
    CHECK(panels[0].longest_limit == 20);
    // The setting that came last stands with its planner.
    CHECK(panels[0].series[3].setting == "paper");
    CHECK(panels[0].series[3].planner == "rrt_connect");
    CHECK(panels[0].series[4].planner == "prm");
    CHECK(short_label(panels[0].series[3]) == "gl, paper");
  }

  TEST_CASE("Bad paths and time-outs are failures at their limit; invalid problems are no runs") {
    std::vector<BenchmarkRow> rows = {test::run(0.5), test::run(0.1), test::run(3, false),
                                      test::run(3, false)};
    for (BenchmarkRow& row : rows) row.timeout_s = 3;
    rows[1].is_path_valid = false;
    rows[3].status = PlanStatus::invalid_start;
    const auto panels = make_panels(rows, false);
    REQUIRE(panels.size() == 1);
    const Series& series = panels[0].series[0];
    CHECK(series.run_count() == 3);
    CHECK(series.summary.total == 4);
    CHECK(series.summary.invalid_paths == 1);
    CHECK(series.solved_times == std::vector<double>{0.5});
    CHECK(series.limits == std::vector<double>{3, 3});
    CHECK(series.rows.size() == 3);
  }

  TEST_CASE("Problems have panels of their own if asked for") {
    auto rows = test::suite_rows();
    rows[0].problem = "S2";
    const auto panels = make_panels(rows, true);
    REQUIRE(panels.size() == 2);
    CHECK(panels[0].name == "scenario / S2");
  }

  TEST_CASE("Names of files keep letters and digits only") {
    CHECK(file_name("a b/ü.c-1") == "a_b___.c-1");
  }
}

}  // namespace
}  // namespace mneme::internal
