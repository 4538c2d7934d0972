// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/schema.h"

#include "experience/row_codec.h"

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
constexpr std::array kTables = {
    Table{
        "experience",
        "CREATE TABLE experience ("
        "id INTEGER PRIMARY KEY, key BLOB NOT NULL, means BLOB NOT NULL, factor_rows BLOB NOT "
        "NULL, "
        "factors BLOB NOT NULL, origins BLOB NOT NULL, tool TEXT NOT NULL, settings TEXT NOT NULL, "
        "seed INTEGER NOT NULL, time TEXT NOT NULL, checksum INTEGER NOT NULL) STRICT"},
    Table{"space",
          "CREATE TABLE space ("
          "id INTEGER PRIMARY KEY CHECK (id = 1), robot_name TEXT NOT NULL, robot_hash TEXT NOT "
          "NULL, "
          "decomposer TEXT NOT NULL, joint_count INTEGER NOT NULL, key_size INTEGER NOT NULL, "
          "checksum INTEGER NOT NULL) STRICT"},
    Table{"tally",
          "CREATE TABLE tally ("
          "id INTEGER PRIMARY KEY CHECK (id = 1), row_count INTEGER NOT NULL, digest INTEGER NOT "
          "NULL) "
          "STRICT"},
};

// Three rows of seventy means of an eight-joint arm fill such a page; of 4096 bytes one row would
// waste half.
constexpr const char* kPageSize = "PRAGMA page_size = 8192";

std::int64_t checksum_of(const ExperienceSpace& space) {
  const std::string text = fmt::format("{}\n{}\n{}\n{}\n{}", space.robot_name, space.robot_hash,
                                       space.decomposer, space.joint_count, space.key_size);
  return hash_bytes(std::as_bytes(std::span(text)));
}

tl::unexpected<Error> damaged(const Connection& connection, std::string_view what) {
  return fail(ErrorCode::corrupt, fmt::format("{}: {}", connection.path(), what));
}

/// Errors unless the tables are exactly those of kTables.
Result<void> check_tables(Connection& connection) {
  auto statement = connection.prepare(
      "SELECT name, sql FROM sqlite_schema WHERE name NOT LIKE 'sqlite_%' ORDER BY name");
  if (!statement) return tl::unexpected(statement.error());
  std::size_t count = 0;
  for (;; ++count) {
    const auto has_row = statement->step();
    if (!has_row) return tl::unexpected(has_row.error());
    if (!*has_row) break;
    if (count >= kTables.size() || statement->text(0) != kTables[count].name ||
        statement->text(1) != kTables[count].sql) {
      return damaged(connection, fmt::format("the table '{}' is not one that mneme creates",
                                             statement->text(0)));
    }
  }
  if (count == kTables.size()) return {};
  return damaged(connection, fmt::format("the table '{}' is missing", kTables[count].name));
}

Result<void> write_space(Connection& connection, const ExperienceSpace& space) {
  auto insert = connection.prepare("INSERT INTO space VALUES (1, ?, ?, ?, ?, ?, ?)");
  if (!insert) return tl::unexpected(insert.error());
  insert->bind(1, space.robot_name).bind(2, space.robot_hash).bind(3, space.decomposer);
  insert->bind(4, space.joint_count).bind(5, space.key_size).bind(6, checksum_of(space));
  const auto inserted = insert->step();
  if (!inserted) return tl::unexpected(inserted.error());
  return connection.execute("INSERT INTO tally VALUES (1, 0, 0)");
}

Result<void> write_tables(Connection& connection) {
  for (const Table& table : kTables) {
    const auto created = connection.execute(std::string(table.sql).c_str());
    if (!created) return created;
  }
  return connection.execute(fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}",
                                        kApplicationId, kSchemaVersion)
                                .c_str());
}

}  // namespace

Result<FileKind> identify(Connection& connection) {
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
    return FileKind::empty;
  }
  if (is_stranger) return damaged(connection, "an SQLite file, but no mneme database");
  if (version > kSchemaVersion) {
    return fail(ErrorCode::unsupported,
                fmt::format("{}: written by a newer mneme (schema {}; this one reads up to {})",
                            connection.path(), version, kSchemaVersion));
  }
  if (version != kSchemaVersion) {
    return damaged(connection, fmt::format("schema {} was never in use", version));
  }
  const auto checked = check_tables(connection);
  if (!checked) return tl::unexpected(checked.error());
  return FileKind::database;
}

Result<void> create_schema(Connection& connection, const ExperienceSpace& space) {
  const auto sized = connection.execute(kPageSize);
  if (!sized) return sized;
  auto transaction = Transaction::begin(connection, Transaction::Kind::write);
  if (!transaction) return tl::unexpected(transaction.error());
  const auto kind = identify(connection);
  if (!kind) return tl::unexpected(kind.error());
  if (*kind == FileKind::database) return {};
  return write_tables(connection)
      .and_then([&] { return write_space(connection, space); })
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
  auto statement = connection.prepare(
      "SELECT robot_name, robot_hash, decomposer, joint_count, key_size, checksum FROM space");
  if (!statement) return tl::unexpected(statement.error());
  const auto has_row = statement->step();
  if (!has_row) return tl::unexpected(has_row.error());
  if (!*has_row) return damaged(connection, "the row that names the robot is missing");
  ExperienceSpace space;
  space.robot_name = statement->text(0);
  space.robot_hash = statement->text(1);
  space.decomposer = statement->text(2);
  space.joint_count = static_cast<int>(statement->integer(3));
  space.key_size = static_cast<int>(statement->integer(4));
  if (statement->integer(5) != checksum_of(space) || space.joint_count < 1 || space.key_size < 1) {
    return damaged(connection, "the row that names the robot is damaged");
  }
  return space;
}

}  // namespace mneme::internal
