// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmark/bench_support.h"

#include <sqlite3.h>

namespace mneme {
namespace {

/// The answer of another connection, as text.
std::string ask_runs(const std::string& path, const std::string& sql) {
  sqlite3* handle = nullptr;
  REQUIRE(sqlite3_open_v2(path.c_str(), &handle, SQLITE_OPEN_READONLY, nullptr) == SQLITE_OK);
  sqlite3_stmt* statement = nullptr;
  REQUIRE_MESSAGE(sqlite3_prepare_v2(handle, sql.c_str(), -1, &statement, nullptr) == SQLITE_OK,
                  sqlite3_errmsg(handle));
  REQUIRE(sqlite3_step(statement) == SQLITE_ROW);
  const std::string text = reinterpret_cast<const char*>(sqlite3_column_text(statement, 0));
  sqlite3_finalize(statement);
  sqlite3_close(handle);
  return text;
}

TEST_SUITE("unit") {
  TEST_CASE("Rows can be read by others while they come, with the columns of the CSV file") {
    const test::TemporaryDirectory directory;
    const std::string path = directory / "runs.sqlite";
    const auto rows = test::suite_rows();
    auto database = RunDatabase::open(path, std::span(rows).first(2));
    REQUIRE_MESSAGE(database.has_value(), (database ? "" : database.error().message));
    CHECK(ask_runs(path, "SELECT count(*) FROM runs") == "2");
    REQUIRE(database->add(rows[2]).has_value());
    CHECK(ask_runs(path, "SELECT count(*) FROM runs") == "3");
    CHECK(ask_runs(path,
                   "SELECT seed || ' ' || sampler || ' ' || is_valid || ' ' || settings FROM runs "
                   "WHERE seed = 3") == "3 gl 1 range=0.5 memory=grid");
    CHECK(std::stod(ask_runs(path, "SELECT planning_time_s FROM runs WHERE seed = 3")) ==
          doctest::Approx(rows[2].planning_time_s));
    const std::string header = csv_header();
    CHECK(ask_runs(path, "SELECT group_concat(name) || char(10) FROM pragma_table_info('runs')") ==
          header);
  }

  TEST_CASE("Opening refuses SQLite files of others, and leaves them as they are") {
    const test::TemporaryDirectory directory;
    for (const char* sql : {"CREATE TABLE runs (marathon TEXT)", "CREATE TABLE walks (a)",
                            "CREATE TABLE runs (problem, \"set\", planner, sampler, is_valid); "
                            "CREATE TABLE walks (a)",
                            "PRAGMA application_id = 7"}) {
      CAPTURE(sql);
      const std::string path = directory / std::to_string(std::hash<std::string_view>()(sql));
      sqlite3* handle = nullptr;
      REQUIRE(sqlite3_open(path.c_str(), &handle) == SQLITE_OK);
      REQUIRE(sqlite3_exec(handle, sql, nullptr, nullptr, nullptr) == SQLITE_OK);
      sqlite3_close(handle);
      const std::string before = test::read_file(path);
      const auto opened = RunDatabase::open(path, test::suite_rows());
      REQUIRE_FALSE(opened.has_value());
      CHECK(opened.error().code == ErrorCode::invalid);
      CHECK(opened.error().message.find(path) != std::string::npos);
      CHECK(test::read_file(path) == before);
    }
  }

  TEST_CASE("Opening replaces the table, and refuses what is no SQLite file") {
    const test::TemporaryDirectory directory;
    const std::string path = directory / "runs.sqlite";
    const auto rows = test::suite_rows();
    REQUIRE(RunDatabase::open(path, rows).has_value());
    REQUIRE(RunDatabase::open(path, std::span(rows).first(1)).has_value());
    CHECK(ask_runs(path, "SELECT count(*) FROM runs") == "1");
    test::write_file(directory / "text", std::string(5000, 'x'));
    CHECK_FALSE(RunDatabase::open(directory / "text", rows).has_value());
    CHECK_FALSE(RunDatabase::open(directory / "no/runs.sqlite", rows).has_value());
  }
}

}  // namespace
}  // namespace mneme
