// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmark/comparisons.h"

#include "benchmark/bench_support.h"

namespace mneme::internal {
namespace {

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
    for (const Comparison& comparison : comparisons) {
      CHECK(comparison.kind == "sampler");
      CHECK(comparison.reference->sampler == "uniform");
      CHECK(comparison.reference->planner == comparison.other->planner);
      CHECK(comparison.ratio.pairs == 20);
    }
    CHECK(compare_series(panels[0], "none").empty());
  }

  TEST_CASE("A setting without a baseline borrows one, settings are compared with the first") {
    const std::vector<BenchmarkRow> rows = {row_of("rrt", "uniform", "a"), row_of("rrt", "gl", "a"),
                                            row_of("rrt", "gl", "b")};
    const auto panels = make_panels(rows, false);
    const auto comparisons = compare_series(panels[0], "uniform");
    REQUIRE(comparisons.size() == 3);
    CHECK(comparisons[1].other->setting == "b");
    CHECK(comparisons[1].reference->setting == "a");
    CHECK(comparisons[2].kind == "setting");
    CHECK(comparisons[2].reference->setting == "a");
    CHECK(comparisons[2].reference->sampler == "gl");
  }

  TEST_CASE("Native planners are compared with OMPL's of the same name and sampler") {
    const std::vector<BenchmarkRow> rows = {row_of("rrt_connect", "gl", ""),
                                            row_of("ompl:RRTConnect", "gl", ""),
                                            row_of("ompl:PRM", "gl", "")};
    const auto panels = make_panels(rows, false);
    const auto comparisons = compare_series(panels[0], "uniform");
    REQUIRE(comparisons.size() == 1);
    CHECK(comparisons[0].kind == "planner");
    CHECK(comparisons[0].other->planner == "rrt_connect");
    CHECK(comparisons[0].reference->planner == "ompl:RRTConnect");
  }

  TEST_CASE("Ratios are written with their interval and what they bound") {
    CHECK(format_ratio({27.12, 4.8, 133, false, false}) == "27.1 (4.80 to 133)");
    CHECK(format_ratio({0.0123, 0.01, 0.5, true, false}) == "≥ 0.012 (0.01 to 0.50)");
    CHECK(format_ratio({2, 1, 3, false, true}) == "≤ 2.00 (1.00 to 3.00)");
    CHECK(format_ratio({2, 1, 3, true, true}) == "open");
  }
}

}  // namespace
}  // namespace mneme::internal
