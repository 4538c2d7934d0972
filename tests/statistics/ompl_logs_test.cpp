// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "statistics/bench_support.h"

#include <sqlite3.h>

#include <cstdlib>
#include <sstream>

namespace mneme {
namespace {

using test::contains;

/// All rows of a query as text.
std::string ask(const std::string& path, const std::string& sql) {
  sqlite3* handle = nullptr;
  REQUIRE(sqlite3_open_v2(path.c_str(), &handle, SQLITE_OPEN_READONLY, nullptr) == SQLITE_OK);
  std::string text;
  const auto append = [](void* to, int count, char** values, char**) {
    for (int i = 0; i < count; ++i) {
      *static_cast<std::string*>(to) += std::string(values[i] ? values[i] : "NULL") + "|";
    }
    *static_cast<std::string*>(to) += "\n";
    return 0;
  };
  CHECK_MESSAGE(sqlite3_exec(handle, sql.c_str(), append, &text, nullptr) == SQLITE_OK,
                sqlite3_errmsg(handle));
  sqlite3_close(handle);
  return text;
}

TEST_SUITE("unit") {
  TEST_CASE("A problem is an experiment, a planner with sampler and setting a configuration") {
    const auto logs = to_ompl_logs(test::suite_rows());
    REQUIRE(logs.size() == 1);
    CHECK(logs[0].experiment == "scenario_S1");
    const std::string& text = logs[0].text;
    CHECK(
        text.starts_with("mneme version " + std::string(version()) + "\nExperiment scenario_S1\n"));
    for (const char* part :
         {"\nStarting at 2026-01-31 12:00:00\n", "\n20 seconds per run\n",
          "\n20 runs per planner\n",
          "\n9 planners\nrrt_connect_gl_tuned\n4 common properties\n"
          "sampler = gl\ntimeout = 20\nrange = 0.5\nmemory = grid\n16 properties for each run\n"}) {
      CHECK_MESSAGE(contains(text, part), part);
    }
    std::istringstream lines(text);
    int planners = 0, runs = 0;
    for (std::string line; std::getline(lines, line);) {
      planners += line == "." ? 1 : 0;
      runs += line.ends_with("; ") ? 1 : 0;
    }
    CHECK(planners == 9);
    CHECK(runs == 180);
  }

  TEST_CASE("Failures stand at the limit, and a path that did not survive is one") {
    std::vector<BenchmarkRow> rows = {test::run(0.5), test::run(0.5), test::run(3, false)};
    for (BenchmarkRow& row : rows) row.timeout_s = 3;
    rows[0].path_length = 2;
    rows[1].is_path_valid = false;
    const std::string text = to_ompl_logs(rows)[0].text;
    const std::size_t begin = text.find("\n3 runs\n");
    REQUIRE(begin != std::string::npos);
    std::istringstream lines(text.substr(begin + 8));
    for (const char* expected :
         {"1; 1; 0.5; 0; 2; 6; ", "0; 0; 3; 0; ; 4; ", "0; 0; 3; 0; ; 4; "}) {
      std::string line;
      std::getline(lines, line);
      CHECK_MESSAGE(line.starts_with(expected), line);
    }
  }

  TEST_CASE("Blanks and line breaks in names cannot break the format") {
    std::vector<BenchmarkRow> rows = {test::run(1)};
    rows[0].set = "a b\nc";
    rows[0].setting = "x\ny";
    const auto logs = to_ompl_logs(rows);
    CHECK(logs[0].experiment == "a_b_c_S1");
    CHECK(contains(logs[0].text, "\nrrt_connect_gl_x_y\n"));
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("ompl_benchmark_statistics makes a database of the logs") {
    if (std::system("command -v ompl_benchmark_statistics > /dev/null 2>&1") != 0) {
      MESSAGE("skipped: ompl_benchmark_statistics is not installed");
      return;
    }
    const test::TemporaryDirectory directory;
    auto rows = test::suite_rows();
    for (std::size_t i = 0; i < 30; ++i) rows[i].problem = "second";
    std::string command = "ompl_benchmark_statistics -d " + (directory / "runs.db");
    for (const OmplLog& log : to_ompl_logs(rows)) {
      test::write_file(directory / (log.experiment + ".log"), log.text);
      command += " " + (directory / (log.experiment + ".log"));
    }
    REQUIRE(std::system((command + " > /dev/null 2>&1").c_str()) == 0);
    CHECK(ask(directory / "runs.db", "SELECT count(*), sum(solved) FROM runs") == "180|173|\n");
    CHECK(ask(directory / "runs.db", "SELECT count(*) FROM experiments") == "2|\n");
    CHECK(ask(directory / "runs.db", "SELECT count(*) FROM plannerConfigs") == "9|\n");
  }
}

}  // namespace
}  // namespace mneme
