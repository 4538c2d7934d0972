// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/experience.h"

#include "demo_cell.h"
#include "demo_finding.h"
#include "apps/run_program.h"

#include <algorithm>

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
          "A planar arm in a gap between two circles, median planning times. a: 2 ms with memory "
          "instead of 30 ms, 15 times faster; b: solves 1 of 1 runs with memory (4 ms), 0 of 1 "
          "without; c: 4 ms with memory instead of 2 ms, 2 times slower; d: solves 0 of 1 runs "
          "with memory, 1 of 1 without; f: memory gains nothing (2 ms with and 2 ms without).\n\n");
    CHECK(app::describe_finding({}).empty());
    CHECK(app::describe_finding(std::vector<BenchmarkRow>{row("a", "gl", 1, "open")}).empty());
  }
}

TEST_SUITE("unit") {
  TEST_CASE("the finding of a cell has medians, replays and how far paths deviate") {
    app::CellRuns runs;
    CHECK(app::describe_cell("Fetch", runs).empty());
    runs.tasks = 2;
    runs.repeats = {
        {0.004, 0.001, 3, 0.1, true}, {0.002, 0.0005, 2, 0.2, true}, {0.006, 0.006, 4, 4, false}};
    CHECK(app::describe_cell("Fetch", runs) ==
          "In a cell, Fetch repeats 2 tasks with obstacles and goals moved by up to 1 cm. From the "
          "call to the proven path, 1 ms with memory instead of 4 ms, 4 times faster. 2 of 3 "
          "repetitions were replayed, the others planned. Paths repeat: at the median, a path from "
          "memory stays within 0.2 rad of the first path of its task, a planned one within 3 "
          "rad.\n\n");
  }

  TEST_CASE("tasks of a cell are planned once and replayed, free of contact") {
    const TemporaryDirectory files;
    const Problem base = load_problem(source_file("scenes/shelf/thin.yaml")).value();
    Database memory =
        Database::open(files / "cell.db", make_signature(base.robot), OpenMode::create).value();
    const app::CellRuns runs = app::run_cell(base, 2, 3, 1, memory).value();
    CHECK(runs.tasks == 2);
    CHECK(memory.size() == 2);
    CHECK(runs.repeats.size() + static_cast<std::size_t>(runs.unsolved) == 6);
    CHECK(runs.wrong == 0);
    CHECK(std::ranges::count_if(runs.repeats, &app::RepeatedTask::is_replayed) >= 3);
    CHECK(runs.longest.size() >= 2);
    REQUIRE(runs.shown.has_value());
  }

  TEST_CASE("paths deviate by their farthest states at equal fractions") {
    const Robot robot = load_robot(source_file("robots/planar8.urdf")).value();
    const Configuration zero(8, 0.0);
    Configuration end = zero, aside = zero;
    end[1] = 1, aside[1] = 0.5, aside[2] = 0.3;
    CHECK(app::path_deviation(robot, {zero, end}, {zero, end}) == doctest::Approx(0));
    CHECK(app::path_deviation(robot, {zero, end}, {zero, aside, end}) == doctest::Approx(0.3));
    CHECK(app::path_deviation(robot, {zero, end}, {}) == 0);
  }
}

}  // namespace
}  // namespace mneme::test
