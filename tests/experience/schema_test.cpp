// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/fixtures.h"

#include "experience/schema.h"

namespace mneme::test {
namespace {

using internal::Connection;

Connection open_connection(const std::string& path) {
  auto connection = Connection::open(path, Connection::Access::create);
  REQUIRE(connection.has_value());
  return std::move(*connection);
}

void create(const std::string& path) {
  Connection connection = open_connection(path);
  REQUIRE(internal::create_schema(connection, arm_space()));
}

/// What becomes of a database when `sql` is done to it.
Result<int> kind_after(const std::string& sql) {
  const TemporaryDirectory directory;
  create(directory / "a.db");
  run_sql(directory / "a.db", sql);
  Connection connection = open_connection(directory / "a.db");
  return internal::identify(connection);
}

void check_refused(const std::string& sql, ErrorCode code, const std::string& reason) {
  INFO(sql);
  const auto kind = kind_after(sql);
  REQUIRE(!kind.has_value());
  CHECK(kind.error().code == code);
  CHECK_MESSAGE(kind.error().message.find(reason) != std::string::npos, kind.error().message);
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a file is empty before its schema is created and a database after") {
    const TemporaryDirectory directory;
    Connection connection = open_connection(directory / "a.db");
    CHECK(internal::identify(connection) == 0);
    REQUIRE(internal::create_schema(connection, arm_space()));
    CHECK(internal::identify(connection) == internal::kSchemaVersion);
    const auto space = internal::read_space(connection);
    REQUIRE(space.has_value());
    CHECK(space->robot_name == "arm");
    CHECK(space->robot_hash == "0123456789abcdef");
    CHECK(space->joint_count == 3);
  }

  TEST_CASE("creating a schema that another process has created changes nothing") {
    const TemporaryDirectory directory;
    create(directory / "a.db");
    Connection connection = open_connection(directory / "a.db");
    ExperienceSpace other = arm_space();
    other.robot_name = "other";
    REQUIRE(internal::create_schema(connection, other));
    CHECK(internal::read_space(connection)->robot_name == "arm");
  }

  TEST_CASE("the pragmas that tell what the file is are set") {
    const TemporaryDirectory directory;
    create(directory / "a.db");
    Connection connection = open_connection(directory / "a.db");
    CHECK(connection.integer("PRAGMA application_id") == 0x6d6e656d);
    CHECK(connection.integer("PRAGMA user_version") == 3);
    CHECK(connection.integer("PRAGMA page_size") == 8192);
  }

  TEST_CASE("a database of a newer schema is refused as such") {
    check_refused("PRAGMA user_version = 7; CREATE TABLE more (a)", ErrorCode::unsupported,
                  "was written by a newer mneme (schema 7); this one reads schema 3");
  }

  TEST_CASE("a version of its own is damage if the tables are known ones") {
    check_refused("PRAGMA user_version = 7", ErrorCode::corrupt, "user_version is 7");
  }

  TEST_CASE("a file that is no database of ours is refused") {
    check_refused("PRAGMA user_version = 0", ErrorCode::corrupt, "schema 0 was never in use");
    check_refused("PRAGMA application_id = 5", ErrorCode::corrupt, "no mneme database");
    check_refused("PRAGMA application_id = 0", ErrorCode::corrupt, "no mneme database");
  }

  TEST_CASE("tables that are not as they were created are damage") {
    check_refused("DROP INDEX tombstone_row", ErrorCode::corrupt,
                  "table 'tombstone_row' is missing");
    check_refused("CREATE TABLE more (a)", ErrorCode::corrupt, "'more' is not one");
    check_refused("CREATE TRIGGER t AFTER INSERT ON experience BEGIN DELETE FROM experience; END",
                  ErrorCode::corrupt, "'t' is not one");
    check_refused("ALTER TABLE experience RENAME COLUMN key TO key2", ErrorCode::corrupt,
                  "'experience' is not one");
  }

  TEST_CASE("a database of an older schema is refused, and told what to do") {
    check_refused("PRAGMA user_version = 2; ALTER TABLE experience DROP COLUMN cell",
                  ErrorCode::unsupported,
                  "was written by an older mneme (schema 2); this one reads schema 3: learn anew");
    check_refused("PRAGMA user_version = 2", ErrorCode::corrupt, "user_version is 2");
  }

  TEST_CASE("statistics that SQLite keeps for itself are no damage") {
    CHECK(kind_after("ANALYZE") == internal::kSchemaVersion);
  }

  TEST_CASE("a changed or missing space is damage, not another robot") {
    for (const std::string change :
         {"UPDATE space SET robot_hash = '0123456789abcdee'", "UPDATE space SET joint_count = 4",
          "UPDATE space SET checksum = checksum + 1", "DELETE FROM space"}) {
      const TemporaryDirectory directory;
      create(directory / "a.db");
      run_sql(directory / "a.db", change);
      Connection connection = open_connection(directory / "a.db");
      const auto space = internal::read_space(connection);
      INFO(change);
      REQUIRE(!space.has_value());
      CHECK(space.error().code == ErrorCode::corrupt);
    }
  }

  TEST_CASE("pages that do not fit together are found") {
    const TemporaryDirectory directory;
    create(directory / "a.db");
    {
      Connection connection = open_connection(directory / "a.db");
      CHECK(internal::check_pages(connection).has_value());
    }
    std::string bytes = read_file(directory / "a.db");
    bytes[39] = 1;  // the header now counts one free page, but the list of free pages is empty
    write_file(directory / "a.db", bytes);
    Connection connection = open_connection(directory / "a.db");
    const auto checked = internal::check_pages(connection);
    REQUIRE(!checked.has_value());
    CHECK(checked.error().code == ErrorCode::corrupt);
  }
}

}  // namespace mneme::test
