// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "store/sqlite_store.h"

#include <fmt/format.h>

#include <array>
#include <string>
#include <string_view>

namespace mneme::internal {
namespace {

struct Table {
  std::string_view name;
  std::string_view sql;  ///< as SQLite keeps it, so that a changed schema is noticed
};

// In alphabetical order of names.
// Keys stand apart from mixtures, so that an index over all keys reads a tenth of the bytes.
constexpr std::array kFileTables = {
    Table{"experience",
          "CREATE TABLE experience ("
          "id INTEGER PRIMARY KEY, generation INTEGER NOT NULL, cell INTEGER NOT NULL, kind TEXT "
          "NOT NULL, content BLOB NOT NULL, components INTEGER NOT NULL, key BLOB NOT NULL, "
          "checksum INTEGER NOT "
          "NULL) STRICT"},
    Table{"experience_content", "CREATE INDEX experience_content ON experience (content)"},
    Table{"experience_kind", "CREATE INDEX experience_kind ON experience (kind)"},
    Table{"head",
          "CREATE TABLE head ("
          "id INTEGER PRIMARY KEY CHECK (id = 1), generation INTEGER NOT NULL, epoch INTEGER NOT "
          "NULL, last_row INTEGER NOT NULL, last_tombstone INTEGER NOT NULL, row_count INTEGER "
          "NOT NULL, row_digest INTEGER NOT NULL, tombstone_count INTEGER NOT NULL, "
          "tombstone_digest INTEGER NOT NULL, checksum INTEGER NOT NULL) STRICT"},
    Table{"mixture",
          "CREATE TABLE mixture ("
          "id INTEGER PRIMARY KEY, cell INTEGER NOT NULL, means BLOB NOT NULL, factor_rows BLOB "
          "NOT NULL, factors BLOB NOT NULL, origins BLOB NOT NULL, tool TEXT NOT NULL, settings "
          "TEXT NOT NULL, seed INTEGER NOT NULL, time TEXT NOT NULL, checksum INTEGER NOT NULL) "
          "STRICT"},
    Table{"space",
          "CREATE TABLE space ("
          "id INTEGER PRIMARY KEY CHECK (id = 1), robot_name TEXT NOT NULL, robot_hash TEXT NOT "
          "NULL, joint_count INTEGER NOT NULL, checksum INTEGER NOT NULL) STRICT"},
    Table{"tombstone",
          "CREATE TABLE tombstone ("
          "id INTEGER PRIMARY KEY, row INTEGER NOT NULL, generation INTEGER NOT NULL, reason TEXT "
          "NOT NULL, time TEXT NOT NULL, checksum INTEGER NOT NULL) STRICT"},
    Table{"tombstone_row", "CREATE INDEX tombstone_row ON tombstone (row)"},
};

// Nine mixtures of 24 means of an eight-joint arm fill such a page.
constexpr const char* kPageSize = "PRAGMA page_size = 8192";

tl::unexpected<Error> damaged(const Connection& connection, std::string_view what) {
  return fail(ErrorCode::corrupt, fmt::format("{}: {}", connection.path(), what));
}

/// Errors unless the tables are exactly kFileTables. What .recover could not place is passed over.
Result<void> check_tables(Connection& connection) {
  auto statement = connection.prepare(
      "SELECT name, sql FROM sqlite_schema WHERE name NOT LIKE 'sqlite_%' AND NOT (type = 'table' "
      "AND name LIKE 'lost_and_found%') ORDER BY name");
  if (!statement) return tl::unexpected(statement.error());
  std::size_t count = 0;
  for (;; ++count) {
    const auto has_row = statement->step();
    if (!has_row) return tl::unexpected(has_row.error());
    if (!*has_row) break;
    if (count >= kFileTables.size() || statement->text(0) != kFileTables[count].name ||
        statement->text(1) != kFileTables[count].sql) {
      return damaged(connection, fmt::format("the table '{}' is not one that mneme creates",
                                             statement->text(0)));
    }
  }
  if (count == kFileTables.size()) return {};
  return damaged(connection, fmt::format("the table '{}' is missing", kFileTables[count].name));
}

}  // namespace

tl::unexpected<Error> refuse_schema(const std::string& name, std::int64_t version) {
  const bool is_newer = version > kSchemaVersion;
  return fail(ErrorCode::unsupported,
              fmt::format("{}: was written by {} mneme (schema {}); this one reads schema {}: {}",
                          name, is_newer ? "a newer" : "an older", version, kSchemaVersion,
                          is_newer ? "use that one" : "learn anew, into another database"));
}

Result<int> identify(Connection& connection) {
  std::array<std::int64_t, 4> facts{};
  constexpr std::array kQuestions = {"SELECT count(*) FROM sqlite_schema", "PRAGMA application_id",
                                     "PRAGMA user_version", "PRAGMA page_count"};
  for (std::size_t i = 0; i < facts.size(); ++i) {
    const auto answer = connection.integer(kQuestions[i]);
    if (!answer) return tl::unexpected(answer.error());
    facts[i] = *answer;
  }
  const auto [table_count, application, version, page_count] = facts;
  const bool is_stranger = application != kApplicationId;
  if (table_count == 0 && page_count <= 1 && version == 0 && (application == 0 || !is_stranger)) {
    return 0;
  }
  // A file that was saved by .dump has our tables without these numbers.
  if (application == 0 && version == 0 && check_tables(connection)) return kSchemaVersion;
  if (is_stranger) {
    return damaged(connection,
                   "an SQLite file, but no mneme database, or its application_id is damaged");
  }
  if (version == kSchemaVersion) {
    return check_tables(connection).map([] { return kSchemaVersion; });
  }
  if (version < 1) {
    return damaged(connection, fmt::format("schema {} was never in use", version));
  }
  // Another schema has other tables.
  if (!check_tables(connection)) return refuse_schema(connection.path(), version);
  return damaged(connection, fmt::format("its user_version is {}, but not its tables", version));
}

Result<void> mark(Connection& connection) {
  const auto application = MNEME_TRY(connection.integer("PRAGMA application_id"));
  if (application == kApplicationId) return {};
  return connection.execute(fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}",
                                        kApplicationId, kSchemaVersion)
                                .c_str());
}

namespace {

Result<void> create_tables(Connection& connection) {
  for (const Table& table : kFileTables) {
    const auto created = connection.execute(std::string(table.sql).c_str());
    if (!created) return created;
  }
  return mark(connection);
}

Result<void> write_space(Connection& connection, const ExperienceSpace& space) {
  auto insert = connection.prepare("INSERT OR REPLACE INTO space VALUES (1, ?, ?, ?, ?)");
  if (!insert) return tl::unexpected(insert.error());
  insert->bind(1, space.robot_name).bind(2, space.robot_hash).bind(3, space.joint_count);
  insert->bind(4, checksum_of(space));
  const auto inserted = insert->step();
  if (!inserted) return tl::unexpected(inserted.error());
  return {};
}

}  // namespace

Result<void> create_schema(Connection& connection, const ExperienceSpace& space) {
  const auto sized = connection.execute(kPageSize);
  if (!sized) return sized;
  auto transaction = Transaction::begin(connection, Transaction::Kind::write);
  if (!transaction) return tl::unexpected(transaction.error());
  const auto version = identify(connection);
  if (!version) return tl::unexpected(version.error());
  if (*version != 0) return {};
  return create_tables(connection)
      .and_then([&] { return write_space(connection, space); })
      .and_then([&] { return write_head(connection, StoreState{}); })
      .and_then([&] { return transaction->commit(); });
}

Result<void> check_pages(Connection& connection) {
  auto statement = connection.prepare("PRAGMA quick_check(1)");
  if (!statement) return tl::unexpected(statement.error());
  const auto has_row = statement->step();
  if (!has_row) return tl::unexpected(has_row.error());
  if (*has_row && statement->text(0) == "ok") return {};
  return damaged(connection, statement->text(0));
}

Result<ExperienceSpace> read_space(Connection& connection) {
  auto statement =
      connection.prepare("SELECT robot_name, robot_hash, joint_count, checksum FROM space");
  if (!statement) return tl::unexpected(statement.error());
  const auto has_row = statement->step();
  if (!has_row) return tl::unexpected(has_row.error());
  if (!*has_row) return damaged(connection, "the row that names the robot is missing");
  ExperienceSpace space;
  space.robot_name = statement->text(0);
  space.robot_hash = statement->text(1);
  space.joint_count = static_cast<int>(statement->integer(2));
  if (statement->integer(3) != checksum_of(space) || space.joint_count < 1) {
    return damaged(connection, "the row that names the robot is damaged");
  }
  return space;
}

Result<void> replace_space(Connection& connection, const ExperienceSpace& space) {
  auto transaction = Transaction::begin(connection, Transaction::Kind::write);
  if (!transaction) return tl::unexpected(transaction.error());
  return write_space(connection, space).and_then([&] { return transaction->commit(); });
}

}  // namespace mneme::internal
