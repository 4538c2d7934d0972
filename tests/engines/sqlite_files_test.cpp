// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/upkeep.h"

#include "engines/database_file.h"
#include "engines/fixtures.h"
#include "engines/sqlite_connection.h"

#include <sys/stat.h>

namespace mneme::test {
namespace {

using internal::Connection;
using internal::Transaction;

Connection create_connection(const std::string& path) {
  return require(Connection::open(path, Connection::Access::create));
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
      auto insert = require(connection.prepare("INSERT INTO t VALUES (?, ?, ?)"));
      insert.add(std::as_bytes(std::span(value))).add(value).add(INT64_MIN);
      REQUIRE(insert.step() == false);
    }
    auto select = require(connection.prepare("SELECT a, b, c FROM t ORDER BY rowid"));
    REQUIRE(select.step() == true);
    CHECK(select.blob(0).size() == 3);
    CHECK(select.text(1) == bytes);
    CHECK(select.integer(2) == INT64_MIN);
    REQUIRE(select.step() == true);
    CHECK(select.blob(0).empty());
    CHECK(select.text(1).empty());
    CHECK(select.step() == false);
  }

  TEST_CASE("a transaction leaves nothing behind unless it is committed") {
    const TemporaryDirectory directory;
    Connection connection = create_connection(directory / "a.db");
    REQUIRE(connection.execute("CREATE TABLE t (a)"));
    {
      const auto transaction = require(Transaction::begin(connection, Transaction::Kind::write));
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
    const Error error = require_error(connection.integer("SELECT a FROM t"));
    CHECK(error.code == ErrorCode::corrupt);
    CHECK(error.message.find(directory / "a.db") == 0);
    CHECK(contains(error.message, "no such table: t"));
  }

  TEST_CASE("a kept statement begins anew each time, whatever became of the last time") {
    const TemporaryDirectory directory;
    Connection connection = create_connection(directory / "a.db");
    REQUIRE(connection.execute("CREATE TABLE t (a); INSERT INTO t VALUES (1), (2), (3)"));
    constexpr const char* kRows = "SELECT a FROM t WHERE a >= ? ORDER BY a";
    for (const std::int64_t first : {2, 1, 3}) {
      const auto select = require(connection.kept(kRows));
      select->add(first);
      REQUIRE(select->step() == true);
      CHECK(select->integer(0) == first);
    }
    // Nothing of it holds a lock, and it sees what others did to the table.
    run_sql(directory / "a.db", "ALTER TABLE t ADD COLUMN b; UPDATE t SET a = a + 10");
    {
      const auto select = connection.kept(kRows);
      (*select)->add(std::int64_t{3});
      REQUIRE((*select)->step() == true);
      CHECK((*select)->integer(0) == 11);
    }
    run_sql(directory / "a.db", "DROP TABLE t");
    const auto select = connection.kept(kRows);
    const Error error = require_error((*select)->step());
    CHECK(error.code == ErrorCode::corrupt);
    CHECK(contains(error.message, "no such table: t"));
  }

  TEST_CASE("a connection that takes the place of another has its own kept statements") {
    const TemporaryDirectory directory;
    Connection connection = create_connection(directory / "a.db");
    REQUIRE(connection.execute("CREATE TABLE t (a)"));
    CHECK(count(connection) == 0);
    Connection other = create_connection(directory / "b.db");
    REQUIRE(other.execute("CREATE TABLE t (a); INSERT INTO t VALUES (1)"));
    CHECK(count(other) == 1);
    connection = std::move(other);
    CHECK(count(connection) == 1);
    CHECK(connection.integer("SELECT b FROM t").error().message.find(directory / "b.db") == 0);
  }

  TEST_CASE("a file that is not there is only made on request") {
    const TemporaryDirectory directory;
    const Error error =
        require_error(Connection::open(directory / "a.db", Connection::Access::read_write));
    CHECK(error.code == ErrorCode::io);
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
      auto connection = require(Connection::open(path, Connection::Access::immutable));
      CHECK(count(connection) == 1);
    }
  }

  TEST_CASE("a file that is read as immutable cannot be written") {
    const TemporaryDirectory directory;
    REQUIRE(create_connection(directory / "a.db").execute("CREATE TABLE t (a)"));
    auto connection = require(Connection::open(directory / "a.db", Connection::Access::immutable));
    CHECK(connection.is_read_only());
    CHECK(require_error(connection.execute("INSERT INTO t VALUES (1)")).code == ErrorCode::io);
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
    auto connection = require(Connection::open(directory / "a.db", Connection::Access::read_write));
    REQUIRE(connection.execute("INSERT INTO t VALUES (1)"));
    CHECK(count(connection) == 1);
    CHECK(!connection.integer("SELECT count(*) FROM v").has_value());
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

namespace {

constexpr uid_t kNobody = 65534;

/// Runs `body` as someone whom permissions bind, which they do not for root.
int as_ordinary_user(const std::function<int()>& body) {
  return wait_for(start_child([&] {
    if (::geteuid() == 0 && ::setuid(kNobody) != 0) return 99;
    return body();
  }));
}

void permit(const std::string& path, mode_t mode) { REQUIRE(::chmod(path.c_str(), mode) == 0); }

/// A database with two rows, in a directory that its owner may change again afterwards.
struct LockedDirectory {
  LockedDirectory() {
    permit(directory / "", 0755);
    Rng rng(46);
    REQUIRE(open_database(path).insert(random_rows(rng, 2)));
    permit(path, 0444);
    permit(directory / "", 0555);
  }
  ~LockedDirectory() { ::chmod((directory / "").c_str(), 0755); }
  TemporaryDirectory directory;
  std::string path = directory / "a.db";
};

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a missing file, a directory and a pipe are refused with the reason") {
    const TemporaryDirectory directory;
    auto opened = internal::open_for_reading(directory / "a.db");
    REQUIRE(!opened.has_value());
    CHECK(opened.error().code == ErrorCode::io);
    CHECK(opened.error().message == directory / "a.db: cannot be read: No such file or directory");
    CHECK(internal::open_for_writing(directory / "a.db", false).error().message ==
          directory / "a.db: cannot be written: No such file or directory");

    for (const bool can_create : {false, true}) {
      opened = internal::open_for_writing(directory / "", can_create);
      REQUIRE(!opened.has_value());
      CHECK(opened.error().code == ErrorCode::io);
      CHECK(contains(opened.error().message, "is a directory"));
    }

    REQUIRE(::mkfifo((directory / "pipe").c_str(), 0600) == 0);
    opened = internal::open_for_reading(directory / "pipe");
    REQUIRE(!opened.has_value());
    CHECK(contains(opened.error().message, "pipe: expected a regular file"));
  }

  TEST_CASE("a file in a directory that does not exist cannot be created") {
    const TemporaryDirectory directory;
    const Error error = require_error(internal::open_for_writing(directory / "none/a.db", true));
    CHECK(error.code == ErrorCode::io);
    CHECK(error.message.find(directory / "none/a.db") == 0);
  }

  TEST_CASE("a database that may not be read is refused") {
    LockedDirectory locked;
    permit(locked.path, 0);
    CHECK(as_ordinary_user([&] {
            const auto opened = internal::open_for_reading(locked.path);
            return !opened && opened.error().code == ErrorCode::io &&
                           contains(opened.error().message, "Permission denied")
                       ? 0
                       : 1;
          }) == 0);
  }

  TEST_CASE("a read-only database in a read-only directory can be read but not written") {
    const LockedDirectory locked;
    CHECK(as_ordinary_user([&] {
            const auto database = Database::open(locked.path, arm_signature(), OpenMode::read_only);
            return database && database->size() == 2 ? 0 : 1;
          }) == 0);
    CHECK(as_ordinary_user([&] {
            const auto opened = Database::open(locked.path, arm_signature(), OpenMode::read_write);
            return !opened && opened.error().code == ErrorCode::io ? 0 : 1;
          }) == 0);
    CHECK(as_ordinary_user([&] {
            const auto damages = verify_database(locked.path);
            return damages && damages->empty() ? 0 : 1;
          }) == 0);
  }

  TEST_CASE("what is read without locks is read again whatever the directory is by then") {
    const LockedDirectory locked;
    CHECK(as_ordinary_user([&] {
            std::filesystem::current_path(locked.directory / "");
            auto database = Database::open("a.db", arm_signature(), OpenMode::read_only);
            std::filesystem::current_path("/");
            return database && database->refresh() && database->info().bytes > 8192 ? 0 : 1;
          }) == 0);
  }

  TEST_CASE("a writable database in a read-only directory is refused to writers") {
    const LockedDirectory locked;
    permit(locked.path, 0666);
    CHECK(as_ordinary_user([&] {
            const auto opened = Database::open(locked.path, arm_signature(), OpenMode::read_write);
            return !opened && opened.error().code == ErrorCode::io ? 0 : 1;
          }) == 0);
  }

  TEST_CASE("unfinished work in the log is not passed over where it cannot be put in order") {
    LockedDirectory locked;
    permit(locked.directory / "", 0755);
    write_file(locked.path + "-wal", std::string(100, 'x'));
    permit(locked.path + "-wal", 0444);
    permit(locked.directory / "", 0555);
    CHECK(as_ordinary_user([&] {
            const auto opened = Database::open(locked.path, arm_signature(), OpenMode::read_only);
            return !opened && opened.error().code == ErrorCode::io &&
                           contains(opened.error().message, "-wal")
                       ? 0
                       : 1;
          }) == 0);
  }

  TEST_CASE("reading does not leave files beside the database") {
    const TemporaryDirectory directory;
    write_file(directory / "a.db", "");
    open_database(directory / "a.db");
    open_database(directory / "a.db", OpenMode::read_only);
    CHECK(!std::filesystem::exists(directory / "a.db-wal"));
    CHECK(!std::filesystem::exists(directory / "a.db-shm"));
  }

  TEST_CASE("the bytes on disk include the log") {
    const TemporaryDirectory directory;
    write_file(directory / "a.db", std::string(100, 'x'));
    CHECK(internal::bytes_on_disk(directory / "a.db") == 100);
    write_file(directory / "a.db-wal", std::string(20, 'x'));
    CHECK(internal::bytes_on_disk(directory / "a.db") == 120);
    CHECK(internal::bytes_on_disk(directory / "b.db") == 0);
    std::filesystem::create_symlink(directory / "a.db", directory / "link.db");
    CHECK(internal::bytes_on_disk(directory / "link.db") == 120);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("the command that saves a file quotes its name and takes a free one") {
    const TemporaryDirectory directory;
    const std::string path = directory / "it's a.db";
    const std::string first = internal::saving_command(path);
    CHECK(contains(first, "it'\\''s a.db' ."));
    CHECK(contains(first, "s a.db.saved'; "));
    write_file(path + ".saved", "");
    CHECK(contains(internal::saving_command(path), "s a.db.saved2'; "));
  }
}

}  // namespace mneme::test
