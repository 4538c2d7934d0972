// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmark/bench_support.h"

namespace mneme {
namespace {

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
    const auto lines = test::lines_of(to_ratio_table(two_sets(), "uniform"));
    REQUIRE(lines.size() == 4);
    CHECK(lines[1].starts_with("cage"));
    CHECK(lines[1].find("2.00 (2.00 to 2.00)") != std::string::npos);
    CHECK(lines[2].find("8.00 (8.00 to 8.00)") != std::string::npos);
    CHECK(lines[3].starts_with("all"));
    CHECK(lines[3].find("5.00 (5.00 to 5.00)") != std::string::npos);
    CHECK(lines[3].ends_with("4.00 (4.00 to 4.00)"));
  }

  TEST_CASE("One set has no line for all, and without a baseline there is no table") {
    auto rows = two_sets();
    rows.resize(2);
    CHECK(test::lines_of(to_ratio_table(rows, "uniform")).size() == 2);
    CHECK(to_ratio_table(rows, "halton").empty());
    CHECK(to_ratio_table({}, "uniform").empty());
  }
}

}  // namespace
}  // namespace mneme
