// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/fixtures.h"

#include "experience/sqlite_connection.h"

namespace mneme::test {
namespace {

using internal::Connection;
using internal::Transaction;

Connection create_connection(const std::string& path) {
  auto connection = Connection::open(path, Connection::Access::create);
  REQUIRE_MESSAGE(connection.has_value(), (connection ? "" : connection.error().message));
  return std::move(*connection);
}

std::int64_t count(Connection& connection) {
  return connection.integer("SELECT count(*) FROM t").value_or(-1);
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("bytes and text come back as they were bound, empty ones and zeros included") {
    const TemporaryDirectory directory;
    Connection connection = create_connection(directory / "a.db");
    REQUIRE(connection.execute("CREATE TABLE t (a BLOB NOT NULL, b TEXT NOT NULL, c INTEGER)"));
    const std::string bytes("x\0y", 3);
    for (const std::string& value : {bytes, std::string()}) {
      auto insert = connection.prepare("INSERT INTO t VALUES (?, ?, ?)");
      REQUIRE(insert.has_value());
      insert->bind(1, std::as_bytes(std::span(value))).bind(2, value).bind(3, INT64_MIN);
      REQUIRE(insert->step() == false);
    }
    auto select = connection.prepare("SELECT a, b, c FROM t ORDER BY rowid");
    REQUIRE(select.has_value());
    REQUIRE(select->step() == true);
    CHECK(select->blob(0).size() == 3);
    CHECK(select->text(1) == bytes);
    CHECK(select->integer(2) == INT64_MIN);
    REQUIRE(select->step() == true);
    CHECK(select->blob(0).empty());
    CHECK(select->text(1).empty());
    CHECK(select->step() == false);
  }

  TEST_CASE("a transaction leaves nothing behind unless it is committed") {
    const TemporaryDirectory directory;
    Connection connection = create_connection(directory / "a.db");
    REQUIRE(connection.execute("CREATE TABLE t (a)"));
    {
      auto transaction = Transaction::begin(connection, Transaction::Kind::write);
      REQUIRE(transaction.has_value());
      REQUIRE(connection.execute("INSERT INTO t VALUES (1)"));
    }
    CHECK(count(connection) == 0);
    {
      auto transaction = Transaction::begin(connection, Transaction::Kind::write);
      REQUIRE(connection.execute("INSERT INTO t VALUES (1)"));
      REQUIRE(transaction->commit());
    }
    CHECK(count(connection) == 1);
  }

  TEST_CASE("a statement that a sound database would understand names the file as damaged") {
    const TemporaryDirectory directory;
    Connection connection = create_connection(directory / "a.db");
    const auto result = connection.integer("SELECT a FROM t");
    REQUIRE(!result.has_value());
    CHECK(result.error().code == ErrorCode::corrupt);
    CHECK(result.error().message.find(directory / "a.db") == 0);
    CHECK(result.error().message.find("no such table: t") != std::string::npos);
  }

  TEST_CASE("a file that is not there is only made on request") {
    const TemporaryDirectory directory;
    auto connection = Connection::open(directory / "a.db", Connection::Access::read_write);
    REQUIRE(!connection.has_value());
    CHECK(connection.error().code == ErrorCode::io);
    CHECK(!std::filesystem::exists(directory / "a.db"));
  }

  TEST_CASE("names that SQLite gives a meaning to are files like any other") {
    const TemporaryDirectory directory;
    for (const std::string name : {":memory:", "file:a.db?mode=memory", "50%25 #1?immutable=1"}) {
      const std::string path = directory / name;
      {
        Connection connection = create_connection(path);
        REQUIRE(connection.execute("CREATE TABLE t (a); INSERT INTO t VALUES (1)"));
      }
      CHECK(std::filesystem::exists(path));
      auto connection = Connection::open(path, Connection::Access::immutable);
      REQUIRE(connection.has_value());
      CHECK(count(*connection) == 1);
    }
  }

  TEST_CASE("a file that is read as immutable cannot be written") {
    const TemporaryDirectory directory;
    REQUIRE(create_connection(directory / "a.db").execute("CREATE TABLE t (a)"));
    auto connection = Connection::open(directory / "a.db", Connection::Access::immutable);
    REQUIRE(connection.has_value());
    CHECK(connection->is_read_only());
    const auto written = connection->execute("INSERT INTO t VALUES (1)");
    REQUIRE(!written.has_value());
    CHECK(written.error().code == ErrorCode::io);
  }

  TEST_CASE("views and triggers that a file brings along do nothing") {
    const TemporaryDirectory directory;
    sqlite3* handle = nullptr;
    REQUIRE(sqlite3_open((directory / "a.db").c_str(), &handle) == SQLITE_OK);
    REQUIRE(sqlite3_exec(handle,
                         "CREATE TABLE t (a); CREATE VIEW v AS SELECT a FROM t;"
                         "CREATE TRIGGER r AFTER INSERT ON t BEGIN INSERT INTO t VALUES (2); END",
                         nullptr, nullptr, nullptr) == SQLITE_OK);
    REQUIRE(sqlite3_close(handle) == SQLITE_OK);
    auto connection = Connection::open(directory / "a.db", Connection::Access::read_write);
    REQUIRE(connection.has_value());
    REQUIRE(connection->execute("INSERT INTO t VALUES (1)"));
    CHECK(count(*connection) == 1);
    CHECK(!connection->integer("SELECT count(*) FROM v").has_value());
  }

  TEST_CASE("the write-ahead log is in use after it was asked for and gone after closing") {
    const TemporaryDirectory directory;
    {
      Connection connection = create_connection(directory / "a.db");
      REQUIRE(connection.enter_wal_mode());
      REQUIRE(connection.execute("CREATE TABLE t (a)"));
      CHECK(std::filesystem::exists(directory / "a.db-wal"));
    }
    CHECK(!std::filesystem::exists(directory / "a.db-wal"));
  }
}

}  // namespace mneme::test
