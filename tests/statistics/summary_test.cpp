// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "statistics/bench_support.h"
#include "statistics/tables.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <sstream>

namespace mneme {
namespace {

using test::contains;
using test::run;

TEST_SUITE("unit") {
  TEST_CASE("Percentiles are nearest ranks of the sorted times") {
    std::vector<BenchmarkRow> rows;
    for (int i = 20; i >= 1; --i) rows.push_back(run(i));
    const TimeSummary summary = summarize(rows);
    CHECK(summary.runs == 20);
    CHECK(summary.solved == 20);
    CHECK(summary.p50 == 10);
    CHECK(summary.p95 == 19);
    CHECK(summary.p99 == 20);
    CHECK(summary.max == 20);
  }

  TEST_CASE("A failure counts as longer than any success, even one that took longer") {
    const TimeSummary summary = summarize(std::vector{run(1), run(0.5, false), run(2), run(3)});
    CHECK(summary.solved == 3);
    CHECK(summary.p50 == 2);
    CHECK(summary.p95 == 0.5);
    CHECK(summary.max == 0.5);
    CHECK_FALSE(internal::is_censored(summary, 50));
    CHECK(internal::is_censored(summary, 95));
  }

  TEST_CASE("If half of the runs fail, the median of an odd count is a failure") {
    const TimeSummary summary = summarize(std::vector{run(10, false), run(1), run(10, false)});
    CHECK(summary.p50 == 10);
    CHECK(internal::is_censored(summary, 50));
  }

  TEST_CASE("Timing is warm or cold if that of all runs is") {
    std::vector<BenchmarkRow> rows = {run(1), run(1)};
    CHECK(describe_timing(rows) == "cold");
    rows[0].is_warm = true;
    CHECK(describe_timing(rows) == "mixed");
    rows[1].is_warm = true;
    CHECK(describe_timing(rows) == "warm");
  }

  TEST_CASE("No runs give zeros") {
    const TimeSummary summary = summarize({});
    CHECK(summary.runs == 0);
    CHECK(summary.max == 0);
  }

  TEST_CASE("A table has aligned columns, whatever the names hold") {
    std::vector<BenchmarkRow> rows = {run(0.001), run(10, false), run(0.1234)};
    for (BenchmarkRow& row : rows) row.timeout_s = 10;
    rows[1].problem = "a much\nlonger n\xC3\xA4me";
    rows[2].planner = "prm";
    const auto lines = test::lines_of(to_table(rows));
    REQUIRE(lines.size() == 4);
    CHECK(lines[0].starts_with("problem "));
    for (const std::string& line : lines) {
      const auto bytes = static_cast<std::ptrdiff_t>(line.size());
      CHECK(bytes - std::ranges::count(line, '\xC3') ==
            static_cast<std::ptrdiff_t>(lines[0].size()));
    }
    CHECK(lines[1].ends_with("  1/1/1          0    1.00    1.00    1.00    1.00"));
    CHECK(lines[2].ends_with("  0/1/1          0  >10000  >10000  >10000  >10000"));
    CHECK(lines[3].ends_with("  1/1/1          0     123     123     123     123"));
  }
}

TEST_SUITE("law") {
  TEST_CASE("Percentiles never fall, and half of the runs are no longer than the median") {
    Rng rng(11);
    for (int round = 0; round < 300; ++round) {
      CAPTURE(round);
      std::vector<BenchmarkRow> rows;
      for (std::uint32_t i = 0; i <= rng.index(40); ++i) {
        const bool is_solved = rng.uniform() < 0.8;
        rows.push_back(run(is_solved ? rng.uniform() : 1, is_solved));
      }
      const TimeSummary summary = summarize(rows);
      CHECK(summary.p50 <= summary.p95);
      CHECK(summary.p95 <= summary.p99);
      CHECK(summary.p99 <= summary.max);
      const auto within = std::ranges::count_if(
          rows, [&](const BenchmarkRow& row) { return row.planning_time_s <= summary.p50; });
      CHECK(2 * within >= static_cast<std::ptrdiff_t>(rows.size()));
    }
  }
}

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
    rows[0].path_length = 3;
    rows[1].path_length = 7;
    rows[0].duration_s = 2;
    rows[1].duration_s = 9;
    rows[0].total_time_s = 1.5;
    rows[1].total_time_s = 0.75;
    const SetSummary summary = summarize_sets(rows).at(0);
    CHECK(summary.invalid_paths == 1);
    CHECK(summary.times.solved == 1);
    CHECK(summary.times.max == 4);
    CHECK(summary.simplification_p50_s == 0.25);
    CHECK(summary.path_length_mean == 3);
    CHECK(summary.duration_mean_s == 2);
    CHECK(summary.total_times.p50 == 1.5);
    CHECK(summary.total_times.max == 4);
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
    CHECK(contains(line, " 1/2/3 "));
    CHECK(contains(line, " 1.00 "));
    CHECK(contains(line, " >4000 "));
  }
}

}  // namespace

}  // namespace mneme
