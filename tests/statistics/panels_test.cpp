// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "statistics/bench_support.h"
#include "statistics/panels.h"

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
    CHECK(series.valid == 3);
    CHECK(series.total == 4);
    CHECK(series.invalid_paths == 1);
    CHECK(series.solved_times == std::vector<double>{0.5});
    CHECK(series.rows.size() == 3);
  }

  TEST_CASE("There is a panel per problem with by_problem") {
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

BenchmarkRow row_of(const char* planner, const char* sampler, const char* setting) {
  BenchmarkRow row = test::run(1);
  row.planner = planner;
  row.sampler = sampler;
  row.setting = setting;
  return row;
}

TEST_SUITE("unit") {
  TEST_CASE("Samplers are compared with the baseline of their planner and setting") {
    const auto panels = make_panels(test::suite_rows(), false);
    const auto comparisons = compare_series(panels[0], "uniform");
    REQUIRE(comparisons.size() == 6);
    CHECK(comparisons[0].other == "rrt_connect, gl, tuned");
    CHECK(comparisons[0].reference == "rrt_connect, uniform, tuned");
    CHECK(comparisons[5].other == "rrt, halton, tuned");
    CHECK(comparisons[5].reference == "rrt, uniform, tuned");
    for (const SeriesRatio& one : comparisons) CHECK(one.ratio.pairs == 20);
    CHECK(compare_series(panels[0], "none").empty());
  }

  TEST_CASE("A setting without a baseline borrows one, settings are compared with the first") {
    const std::vector<BenchmarkRow> rows = {row_of("rrt", "uniform", "a"), row_of("rrt", "gl", "a"),
                                            row_of("rrt", "gl", "b")};
    const auto panels = make_panels(rows, false);
    const auto comparisons = compare_series(panels[0], "uniform");
    REQUIRE(comparisons.size() == 3);
    CHECK(comparisons[1].other == "rrt, gl, b");
    CHECK(comparisons[1].reference == "rrt, uniform, a");
    CHECK(comparisons[2].other == "rrt, gl, b");
    CHECK(comparisons[2].reference == "rrt, gl, a");
  }

  TEST_CASE("Native planners are compared with OMPL's of the same name and sampler") {
    const std::vector<BenchmarkRow> rows = {row_of("rrt_connect", "gl", ""),
                                            row_of("ompl:RRTConnect", "gl", ""),
                                            row_of("ompl:PRM", "gl", "")};
    const auto panels = make_panels(rows, false);
    const auto comparisons = compare_series(panels[0], "uniform");
    REQUIRE(comparisons.size() == 1);
    CHECK(comparisons[0].other == "rrt_connect, gl");
    CHECK(comparisons[0].reference == "ompl:RRTConnect, gl");
  }
}

}  // namespace

}  // namespace mneme::internal

namespace mneme {
namespace {

using test::contains;

/// One planner, two samplers, two sets of one problem: memory is 2 and 8 times faster.
std::vector<BenchmarkRow> two_sets() {
  std::vector<BenchmarkRow> rows;
  for (const auto& [set, factor] : {std::pair{"cage", 2.0}, {"box", 8.0}}) {
    for (const char* sampler : {"gl", "uniform"}) {
      BenchmarkRow row = test::run(std::string(sampler) == "gl" ? 1 : factor);
      row.set = set;
      row.planner = "rrt_connect";
      row.sampler = sampler;
      rows.push_back(row);
    }
  }
  return rows;
}

TEST_SUITE("unit") {
  TEST_CASE("Every set has a line, and all sets together the last one") {
    const auto lines = test::lines_of(to_table(compare_series(two_sets(), "uniform")));
    REQUIRE(lines.size() == 4);
    CHECK(lines[1].starts_with("cage"));
    CHECK(contains(lines[1], "2.00 (2.00 to 2.00)"));
    CHECK(contains(lines[2], "8.00 (8.00 to 8.00)"));
    CHECK(lines[3].starts_with("all"));
    CHECK(contains(lines[3], "5.00 (5.00 to 5.00)"));
    CHECK(lines[3].ends_with("4.00 (4.00 to 4.00)"));
  }

  TEST_CASE("One set has no line for all, and without a baseline there is no table") {
    auto rows = two_sets();
    rows.resize(2);
    CHECK(test::lines_of(to_table(compare_series(rows, "uniform"))).size() == 2);
    CHECK(compare_series(rows, "halton").empty());
    CHECK(compare_series({}, "uniform").empty());
  }
}

}  // namespace

}  // namespace mneme
