// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmark/bench_support.h"

#include <sqlite3.h>

#include <cstdlib>

namespace mneme {
namespace {

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

bool has_statistics_tool() {
  const bool has_tool = std::system("command -v ompl_benchmark_statistics > /dev/null 2>&1") == 0;
  if (!has_tool) MESSAGE("skipped: ompl_benchmark_statistics is not installed");
  return has_tool;
}

TEST_SUITE("unit") {
  TEST_CASE("The database has the tables of OMPL's tools, and replaces what was there") {
    const test::TemporaryDirectory directory;
    const std::string path = directory / "arena.db";
    for (int i = 0; i < 2; ++i) {
      const auto written = write_planner_arena(path, test::suite_rows());
      REQUIRE_MESSAGE(written.has_value(), (written ? "" : written.error().message));
    }
    CHECK(ask(path, "SELECT count(*) FROM runs") == "180|\n");
    CHECK(ask(path, "SELECT count(*) FROM plannerConfigs") == "9|\n");
    CHECK(ask(path, "SELECT name, timelimit, runcount FROM experiments") ==
          "scenario_S1|20.0|20|\n");
    CHECK(ask(path, "SELECT sum(solved) FROM runs") == "173|\n");
    CHECK_FALSE(std::filesystem::exists(path + ".new"));
    CHECK_FALSE(write_planner_arena(directory / "no/arena.db", test::suite_rows()).has_value());
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("ompl_benchmark_statistics makes the same database of the logs") {
    if (!has_statistics_tool()) return;
    const test::TemporaryDirectory directory;
    auto rows = test::suite_rows();
    for (std::size_t i = 0; i < 30; ++i) rows[i].problem = "second";
    const std::string ours = directory / "ours.db", theirs = directory / "theirs.db";
    REQUIRE(write_planner_arena(ours, rows).has_value());
    std::string command = "ompl_benchmark_statistics -d " + theirs;
    for (const OmplLog& log : to_ompl_logs(rows)) {
      test::write_file(directory / (log.experiment + ".log"), log.text);
      command += " " + (directory / (log.experiment + ".log"));
    }
    REQUIRE(std::system((command + " > /dev/null 2>&1").c_str()) == 0);
    for (const char* table : {"experiments", "plannerConfigs", "enums", "runs", "progress"}) {
      CAPTURE(table);
      const std::string columns =
          ask(theirs, std::string("SELECT name FROM pragma_table_info('") + table + "')");
      CHECK(ask(ours, std::string("SELECT name FROM pragma_table_info('") + table + "')") ==
            columns);
      const std::string query = std::string("SELECT * FROM ") + table;
      CHECK(ask(ours, query) == ask(theirs, query));
    }
  }

  TEST_CASE("ompl_benchmark_statistics adds logs to our database") {
    if (!has_statistics_tool()) return;
    const test::TemporaryDirectory directory;
    const std::string path = directory / "arena.db", log = directory / "more.log";
    REQUIRE(write_planner_arena(path, test::suite_rows()).has_value());
    test::write_file(log, to_ompl_logs(test::suite_rows())[0].text);
    const std::string command = "ompl_benchmark_statistics -a -d " + path + " " + log;
    REQUIRE(std::system((command + " > /dev/null 2>&1").c_str()) == 0);
    CHECK(ask(path, "SELECT count(*) FROM runs") == "360|\n");
    CHECK(ask(path, "SELECT count(*) FROM plannerConfigs") == "9|\n");
  }
}

}  // namespace
}  // namespace mneme
