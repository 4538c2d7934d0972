// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/fail.h"
#include "engines/sqlite_store.h"
#include "engines/row_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

namespace mneme::internal {
namespace {

struct Table {
  std::string_view name;
  std::string_view sql;      ///< exactly as SQLite stores it, to detect a changed schema
  bool is_old = false;       ///< also in kOldSchema
  bool is_optional = false;  ///< missing in files of older builds until it is needed
};

// In alphabetical order of names. Keys are separate from mixtures, so that indexing all keys reads
// a tenth of the bytes.
constexpr std::array kFileTables = {
    Table{"experience",
          "CREATE TABLE experience ("
          "id INTEGER PRIMARY KEY, generation INTEGER NOT NULL, cell INTEGER NOT NULL, kind TEXT "
          "NOT NULL, content BLOB NOT NULL, components INTEGER NOT NULL, constraint_hash INTEGER "
          "NOT NULL, key BLOB NOT NULL, checksum INTEGER NOT NULL) STRICT"},
    Table{"experience_content", "CREATE INDEX experience_content ON experience (content)"},
    Table{"experience_kind", "CREATE INDEX experience_kind ON experience (kind)"},
    Table{"head",
          "CREATE TABLE head ("
          "id INTEGER PRIMARY KEY CHECK (id = 1), generation INTEGER NOT NULL, epoch INTEGER NOT "
          "NULL, last_row INTEGER NOT NULL, last_tombstone INTEGER NOT NULL, row_count INTEGER "
          "NOT NULL, row_digest INTEGER NOT NULL, tombstone_count INTEGER NOT NULL, "
          "tombstone_digest INTEGER NOT NULL, checksum INTEGER NOT NULL) STRICT",
          true},
    Table{
        "lesson",
        "CREATE TABLE lesson (lesson INTEGER NOT NULL, content BLOB NOT NULL, PRIMARY KEY (lesson, "
        "content)) STRICT, WITHOUT ROWID",
        false, true},
    Table{"mixture",
          "CREATE TABLE mixture ("
          "id INTEGER PRIMARY KEY, cell INTEGER NOT NULL, is_path INTEGER NOT NULL, means BLOB NOT "
          "NULL, factor_rows BLOB NOT NULL, factors BLOB NOT NULL, sources BLOB NOT NULL, "
          "is_complete INTEGER NOT NULL, planning_states INTEGER, tool TEXT NOT NULL, settings "
          "TEXT NOT NULL, seed INTEGER NOT NULL, time TEXT NOT NULL, checksum INTEGER NOT NULL) "
          "STRICT"},
    Table{"robot",
          "CREATE TABLE robot ("
          "id INTEGER PRIMARY KEY CHECK (id = 1), robot_name TEXT NOT NULL, kinematics_hash TEXT "
          "NOT NULL, model_hash TEXT NOT NULL, joint_count INTEGER NOT NULL, checksum INTEGER NOT "
          "NULL) STRICT"},
    Table{"tombstone",
          "CREATE TABLE tombstone ("
          "id INTEGER PRIMARY KEY, row INTEGER NOT NULL, generation INTEGER NOT NULL, reason TEXT "
          "NOT NULL, time TEXT NOT NULL, checksum INTEGER NOT NULL) STRICT",
          true},
    Table{"tombstone_row", "CREATE INDEX tombstone_row ON tombstone (row)", true},
};

// A page holds nine mixtures of 24 means of an eight-joint arm.
constexpr const char* kPageSize = "PRAGMA page_size = 8192";

tl::unexpected<Error> damaged(const Connection& connection, std::string_view what) {
  return fail(ErrorCode::corrupt, "{}: {}", connection.path(), what);
}

/// Error: corrupt, unless the tables are exactly kFileTables. Ignores the lost_and_found tables of
/// .recover.
Result<void> check_tables(Connection& connection) {
  auto statement = MNEME_TRY(connection.prepare(
      "SELECT name, sql FROM sqlite_schema WHERE name NOT LIKE 'sqlite_%' AND NOT (type = 'table' "
      "AND name LIKE 'lost_and_found%') ORDER BY name"));
  auto expected = kFileTables.begin();
  const auto skip_optional = [&](std::string_view name) {
    while (expected != kFileTables.end() && expected->is_optional && expected->name != name) {
      ++expected;
    }
  };
  MNEME_TRY(statement.for_each([&]() -> Result<void> {
    skip_optional(statement.text(0));
    const bool is_known = expected != kFileTables.end() && statement.text(0) == expected->name &&
                          statement.text(1) == expected->sql;
    if (is_known) return ++expected, Result<void>();
    return damaged(connection,
                   fmt::format("the table '{}' is not a table of mneme", statement.text(0)));
  }));
  skip_optional("");
  if (expected == kFileTables.end()) return {};
  return damaged(connection, fmt::format("the table '{}' is missing", expected->name));
}

Result<void> create_tables(Connection& connection, bool has_old_ones) {
  for (const Table& table : kFileTables) {
    if (has_old_ones && table.is_old) continue;
    MNEME_TRY(connection.execute(std::string(table.sql).c_str()));
  }
  return {};
}

/// Tables of kOldSchema that a .dump saved without application_id and user_version.
Result<bool> has_old_tables(Connection& connection) {
  const auto count = MNEME_TRY(connection.integer(
      "SELECT count(*) FROM sqlite_schema WHERE type = 'table' AND name IN ('experience', 'head', "
      "'mixture', 'space', 'tombstone')"));
  return count == 5;
}

}  // namespace

tl::unexpected<Error> refuse_schema(const std::string& name, std::int64_t version) {
  const bool is_newer = version > kSchemaVersion;
  return fail(ErrorCode::unsupported,
              "{}: was written by {} mneme (schema {}); this one reads schemas {} and {}: {}", name,
              is_newer ? "a newer" : "an older", version, kOldSchema, kSchemaVersion,
              is_newer ? "use that one" : "learn anew, into another database");
}

Result<int> identify(Connection& connection) {
  std::array<std::int64_t, 4> facts{};
  constexpr std::array kQuestions = {"SELECT count(*) FROM sqlite_schema", "PRAGMA application_id",
                                     "PRAGMA user_version", "PRAGMA page_count"};
  for (std::size_t i = 0; i < facts.size(); ++i) {
    facts[i] = MNEME_TRY(connection.integer(kQuestions[i]));
  }
  const auto [table_count, application, version, page_count] = facts;
  const bool is_ours = application == kApplicationId,
             is_unmarked = application == 0 && version == 0;
  if (table_count == 0 && page_count <= 1 && (is_unmarked || (is_ours && version == 0))) return 0;
  const auto checked = check_tables(connection);
  if (is_ours && version == kSchemaVersion) return checked.map([] { return kSchemaVersion; });
  // .dump saves mneme's tables without application_id and user_version.
  if (is_unmarked && checked) return kSchemaVersion;
  const auto is_old = MNEME_TRY(has_old_tables(connection));
  if (is_unmarked && is_old) return kOldSchema;
  if (!is_ours) {
    return damaged(connection,
                   "an SQLite file but not a mneme database, or its application_id is damaged");
  }
  // Tables of another schema would differ.
  if (checked) {
    return damaged(
        connection,
        fmt::format("its user_version is {}, but its tables are those of another schema", version));
  }
  if (version == kOldSchema) return kOldSchema;
  if (version < 1) return damaged(connection, fmt::format("schema {} was never in use", version));
  return refuse_schema(connection.path(), version);
}

Result<void> mark(Connection& connection) {
  const auto application = MNEME_TRY(connection.integer("PRAGMA application_id"));
  if (application == kApplicationId) return {};
  return connection.execute(fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}",
                                        kApplicationId, kSchemaVersion)
                                .c_str());
}

Result<bool> has_lessons(Connection& connection) {
  return connection.integer("SELECT count(*) FROM sqlite_schema WHERE name = 'lesson'")
      .map([](std::int64_t count) { return count > 0; });
}

Result<void> create_lessons(Connection& connection) {
  const auto exists = MNEME_TRY(has_lessons(connection));
  if (exists) return {};
  const auto table = std::ranges::find(kFileTables, "lesson", &Table::name);
  return connection.execute(std::string(table->sql).c_str());
}

Result<int> create_schema(Connection& connection, const RobotSignature& robot) {
  MNEME_TRY(connection.execute(kPageSize));
  auto transaction = MNEME_TRY(Transaction::begin(connection, Transaction::Kind::write));
  const auto version = MNEME_TRY(identify(connection));
  if (version != 0) return version;
  MNEME_TRY(create_tables(connection, false));
  MNEME_TRY(mark(connection));
  MNEME_TRY(write_signature(connection, robot));
  MNEME_TRY(write_head(connection, StoreState{.epoch = next_epoch(nullptr)}));
  MNEME_TRY(transaction.commit());
  return 0;
}

Result<void> check_pages(Connection& connection) {
  auto statement = MNEME_TRY(connection.prepare("PRAGMA quick_check(1)"));
  const auto has_row = MNEME_TRY(statement.step());
  if (has_row && statement.text(0) == "ok") return {};
  return damaged(connection, statement.text(0));
}

Result<RobotSignature> read_signature(Connection& connection) {
  auto statement =
      MNEME_TRY(connection.prepare(fmt::format("SELECT {} FROM robot", kRobotColumns)));
  const auto has_row = MNEME_TRY(statement.step());
  if (!has_row) return damaged(connection, "the row that names the robot is missing");
  const auto robot = parse_robot(statement);
  if (!robot) return damaged(connection, "the row that names the robot is damaged");
  return *robot;
}

Result<void> write_signature(Connection& connection, const RobotSignature& robot) {
  auto insert =
      MNEME_TRY(connection.prepare("INSERT OR REPLACE INTO robot VALUES (1, ?, ?, ?, ?, ?)"));
  insert.add(std::string_view(robot.robot_name)).add(std::string_view(robot.kinematics_hash));
  insert.add(std::string_view(robot.model_hash)).add(std::int64_t{robot.joint_count});
  return insert.add(checksum_of(robot)).run();
}

Result<StoreState> read_head(Connection& connection) {
  auto statement = MNEME_TRY(connection.prepare(fmt::format("SELECT {} FROM head", kHeadColumns)));
  const auto has_row = MNEME_TRY(statement.step());
  if (!has_row) return damaged(connection, "the tally of rows is missing");
  const auto head = parse_head(statement);
  if (!head) return damaged(connection, "the tally of rows is damaged");
  return *head;
}

Result<void> write_head(Connection& connection, const StoreState& state) {
  auto statement = MNEME_TRY(
      connection.prepare("INSERT OR REPLACE INTO head VALUES (1, ?, ?, ?, ?, ?, ?, ?, ?, ?)"));
  const auto numbers = to_numbers(state);
  for (const std::int64_t number : numbers) statement.add(number);
  return statement.add(hash_numbers(numbers)).run();
}

namespace {

Result<RobotSignature> read_old_signature(Connection& connection) {
  auto statement = MNEME_TRY(
      connection.prepare("SELECT robot_name, robot_hash, joint_count, checksum FROM space"));
  const auto has_row = MNEME_TRY(statement.step());
  if (!has_row) return damaged(connection, "the row that names the robot is missing");
  return upgraded_robot(connection.path(), statement.text(0), statement.text(1),
                        static_cast<int>(statement.integer(2)), statement.integer(3));
}

}  // namespace

Result<void> migrate_tables(Connection& connection,
                            const std::function<Result<void>(const OldRows&)>& write_rows) {
  const RobotSignature robot = MNEME_TRY(read_old_signature(connection));
  MNEME_TRY(connection.execute(
      "DROP INDEX experience_content; DROP INDEX experience_kind; DROP TABLE space;"
      "ALTER TABLE experience RENAME TO old_experience;"
      "ALTER TABLE mixture RENAME TO old_mixture"));
  MNEME_TRY(create_tables(connection, true));
  const auto old_rows = [&](const auto& visit) -> Result<void> {
    auto statement = MNEME_TRY(connection.prepare(
        fmt::format("SELECT {} FROM old_experience e LEFT JOIN old_mixture m ON m.id = e.id ORDER "
                    "BY e.id",
                    kOldColumns)));
    return statement.for_each([&] {
      const StoredRow row = read_row(statement, RowParts::all);
      return visit({&row, 1});
    });
  };
  MNEME_TRY(write_rows(old_rows));
  MNEME_TRY(write_signature(connection, robot));
  MNEME_TRY(connection.execute(
      fmt::format("DROP TABLE old_experience; DROP TABLE old_mixture; PRAGMA application_id = {}; "
                  "PRAGMA user_version = {}",
                  kApplicationId, kSchemaVersion)
          .c_str()));
  return check_tables(connection);
}

}  // namespace mneme::internal
