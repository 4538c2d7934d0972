// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/report_support.h"

#include <sstream>

namespace mneme {
namespace {

using test::run;

BenchmarkRow run_of(const std::string& set, double time, PlanStatus status = PlanStatus::solved) {
  BenchmarkRow row = run(time, status == PlanStatus::solved);
  row.set = set;
  row.status = status;
  row.timeout_s = 4;
  return row;
}

TEST_SUITE("unit") {
  TEST_CASE("Sets are summarised in order of appearance, and then all together") {
    std::vector<BenchmarkRow> rows = {run_of("b", 1), run_of("a", 2), run_of("b", 3)};
    rows[0].iterations = 10;
    rows[2].iterations = 30;
    const auto summaries = summarize_sets(rows);
    REQUIRE(summaries.size() == 3);
    CHECK(summaries[0].set == "b");
    CHECK(summaries[0].times.runs == 2);
    CHECK(summaries[0].times.p50 == 1);
    CHECK(summaries[0].times.max == 3);
    CHECK(summaries[0].iterations_p50 == 10);
    CHECK(summaries[1].set == "a");
    CHECK(summaries[2].set == "all");
    CHECK(summaries[2].total == 3);
    CHECK(summarize_sets(std::vector{rows[0]}).size() == 1);
    CHECK(summarize_sets({}).empty());
  }

  TEST_CASE("Problems whose ends are invalid count in the total alone") {
    const auto summaries = summarize_sets(
        std::vector{run_of("a", 1), run_of("a", 0, PlanStatus::invalid_start),
                    run_of("a", 0, PlanStatus::invalid_goal), run_of("a", 4, PlanStatus::timeout)});
    REQUIRE(summaries.size() == 1);
    CHECK(summaries[0].total == 4);
    CHECK(summaries[0].valid == 2);
    CHECK(summaries[0].times.solved == 1);
    CHECK(summaries[0].times.p50 == 1);
  }

  TEST_CASE("A path that does not survive the check is a failure at the time limit") {
    std::vector<BenchmarkRow> rows = {run_of("a", 1), run_of("a", 0.5)};
    rows[1].is_path_valid = false;
    rows[0].simplification_time_s = 0.25;
    rows[1].simplification_time_s = 0.125;
    const SetSummary summary = summarize_sets(rows).at(0);
    CHECK(summary.invalid_paths == 1);
    CHECK(summary.times.solved == 1);
    CHECK(summary.times.max == 4);
    CHECK(summary.simplification_p50_s == 0.25);
  }

  TEST_CASE("The table says solved, valid and total, and marks failures") {
    const auto summaries =
        summarize_sets(std::vector{run_of("cage", 0.001), run_of("cage", 4, PlanStatus::timeout),
                                   run_of("cage", 0, PlanStatus::invalid_goal)});
    std::istringstream lines(to_table(summaries));
    std::string header;
    std::string line;
    std::getline(lines, header);
    std::getline(lines, line);
    CHECK(header.starts_with("set "));
    CHECK(line.find(" 1/2/3 ") != std::string::npos);
    CHECK(line.find(" 1.00 ") != std::string::npos);
    CHECK(line.find(" >4000 ") != std::string::npos);
  }
}

}  // namespace
}  // namespace mneme
