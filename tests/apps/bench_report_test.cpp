// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "apps/planar_files.h"
#include "statistics/bench_support.h"

#include <cstdlib>
#include <limits>

namespace mneme::test {
namespace {

std::string write_runs(const PlanarFiles& files) {
  const std::string path = files / "runs.csv";
  write_file(path, to_csv(suite_rows()));
  return path;
}

TEST_SUITE("flow") {
  TEST_CASE("A report is a page and its figures; runs of several files are one report") {
    const PlanarFiles files;
    const std::string csv = write_runs(files), page = files / "deep/report.html";
    auto more = suite_rows();
    for (BenchmarkRow& row : more) row.set = "other";
    write_file(files / "more.csv", to_csv(more));
    const ProgramRun run =
        require_run({"bench", "report", csv, files / "more.csv", "-o", page, "--title", "A & B"});
    CHECK(contains(run.out, "360 runs with 2 figures"));
    CHECK(contains(read_file(page), "<h1>A &amp; B</h1>"));
    for (const char* name : {"1_scenario_solved", "2_other_solved"}) {
      CAPTURE(name);
      CHECK(contains(read_file(files / ("deep/report_" + std::string(name) + ".svg")), "<svg"));
    }
  }

  TEST_CASE("The page opens in Chromium without a message on the console") {
    if (std::system("command -v chromium > /dev/null 2>&1") != 0) {
      MESSAGE("skipped: chromium is not installed");
      return;
    }
    const PlanarFiles files;
    REQUIRE(run_program({"bench", "report", write_runs(files), "-o", files / "report.html"})
                .exit_code == 0);
    const std::string command =
        "timeout 60 chromium --headless --no-sandbox --disable-gpu --enable-logging=stderr "
        "--user-data-dir=" +
        files / "profile" + " --dump-dom file://" + files / "report.html" + " > " + files / "dom" +
        " 2> " + files / "log";
    REQUIRE(std::system(command.c_str()) == 0);
    CHECK(contains(read_file(files / "dom"), "scenario"));
    CHECK_FALSE(contains(read_file(files / "log"), "CONSOLE"));
  }

  TEST_CASE("Runs are exported for OMPL's tools") {
    const PlanarFiles files;
    require_run({"bench", "export", write_runs(files), "--ompl-logs", files / "logs"});
    CHECK(contains(read_file(files / "logs/scenario_S1.log"), "Experiment scenario_S1"));
  }
}

TEST_SUITE("unit") {
  TEST_CASE("Files that are no runs end with a message and an exit code") {
    const PlanarFiles files;
    write_file(files / "other.csv", "a,b\n1,2\n");
    write_file(files / "empty.csv", csv_header());
    BenchmarkRow row;
    row.planning_time_s = std::numeric_limits<double>::quiet_NaN();
    write_file(files / "nan.csv", to_csv(std::vector{row}));
    check_bad_inputs({
        {{"bench", "report"}, 2, {"CSV is required"}},
        {{"bench", "report", files / "none.csv"}, 1, {"none.csv: cannot be read"}},
        {{"bench", "report", "/dev/zero"}, 1, {"/dev/zero: expected a regular file"}},
        {{"bench", "report", files / "other.csv"}, 1, {"other.csv:1", "expected the columns"}},
        {{"bench", "report", files / "empty.csv"}, 1, {"empty.csv", "has no runs"}},
        {{"bench", "report", files / "nan.csv"},
         1,
         {"nan.csv: line 2: column planning_time_s: expected a finite number", "got \"nan\""}},
        {{"bench", "export", write_runs(files)}, 2, {"--ompl-logs"}},
    });
  }
}

}  // namespace
}  // namespace mneme::test
