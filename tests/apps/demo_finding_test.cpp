// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "demo_finding.h"
#include "apps/run_program.h"

namespace mneme::test {
namespace {

BenchmarkRow row(const std::string& planner, const std::string& sampler, double time_ms,
                 const std::string& problem = "threaded_b0") {
  BenchmarkRow row;
  row.problem = problem;
  row.planner = planner;
  row.sampler = sampler;
  row.is_solved = time_ms > 0;
  row.planning_time_s = 1e-3 * time_ms;
  return row;
}

TEST_SUITE("unit") {
  TEST_CASE("a demo's finding compares medians, and says how many runs had no path") {
    const std::string finding = app::describe_finding(std::vector<BenchmarkRow>{
        row("a", "gl", 1), row("a", "gl", 2), row("a", "gl", 3), row("a", "uniform", 30),
        row("a", "uniform", 20), row("a", "uniform", 0), row("a", "gl", 99, "open"),
        row("b", "gl", 4), row("b", "uniform", 0), row("c", "gl", 4), row("c", "uniform", 2),
        row("d", "gl", 0), row("d", "uniform", 1), row("e", "gl", 1), row("f", "gl", 2),
        row("f", "uniform", 2)});
    CHECK(finding ==
          "Arms threaded through a gap, median planning times: a takes 2 ms from memory and 30 ms "
          "without, 15 times faster; b takes 4 ms from memory and solves 0 of 1 runs without; c "
          "takes 4 ms from memory and 2 ms without, 2 times slower; d solves 0 of 1 runs from "
          "memory and 1 of 1 without; f gains nothing from memory (2 ms with, 2 ms without).\n\n");
    CHECK(app::describe_finding({}).empty());
    CHECK(app::describe_finding(std::vector<BenchmarkRow>{row("a", "gl", 1, "open")}).empty());
  }
}

}  // namespace
}  // namespace mneme::test
