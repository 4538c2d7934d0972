// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/fail.h"
#include "engines/postgres_store.h"
#include "engines/row_columns.h"
#include "engines/sqlite_store.h"

#include <fmt/format.h>

#include <array>
#include <string>
#include <vector>

namespace mneme::internal {
namespace {

// Primary keys hold the cell, so that a cluster may spread the two large tables by it.
constexpr std::string_view kHeadTable =
    "TABLE mneme_head (id integer PRIMARY KEY CHECK (id = 1), generation bigint NOT NULL, epoch "
    "bigint NOT NULL, last_row bigint NOT NULL, last_tombstone bigint NOT NULL, row_count bigint "
    "NOT NULL, row_digest bigint NOT NULL, tombstone_count bigint NOT NULL, tombstone_digest "
    "bigint NOT NULL, checksum bigint NOT NULL)";
constexpr std::string_view kTombstoneTable =
    "TABLE mneme_tombstone (id bigint PRIMARY KEY, row_id bigint NOT NULL, generation bigint NOT "
    "NULL, reason text NOT NULL, time text NOT NULL, checksum bigint NOT NULL)";
constexpr std::string_view kTombstoneIndex =
    "INDEX mneme_tombstone_row ON mneme_tombstone (row_id)";
constexpr std::string_view kLessonTable =
    "TABLE mneme_lesson (lesson bigint NOT NULL, content bytea NOT NULL, PRIMARY KEY (lesson, "
    "content))";
/// Tables that kOldSchema has in another form.
constexpr std::array kNewTables = {
    std::string_view(
        "TABLE mneme_robot (id integer PRIMARY KEY CHECK (id = 1), schema_version integer NOT "
        "NULL, robot_name text NOT NULL, kinematics_hash text NOT NULL, model_hash text NOT NULL, "
        "joint_count integer NOT NULL, checksum bigint NOT NULL)"),
    std::string_view(
        "TABLE mneme_experience (id bigint NOT NULL, generation bigint NOT NULL, cell bigint NOT "
        "NULL, kind text NOT NULL, content bytea NOT NULL, components bigint NOT NULL, "
        "constraint_hash bigint NOT NULL, key bytea NOT NULL, checksum bigint NOT NULL, PRIMARY "
        "KEY (id, cell))"),
    std::string_view("INDEX mneme_experience_content ON mneme_experience (content)"),
    std::string_view("INDEX mneme_experience_kind ON mneme_experience (kind, id)"),
    std::string_view(
        "TABLE mneme_mixture (id bigint NOT NULL, cell bigint NOT NULL, is_path bigint NOT NULL, "
        "means bytea NOT NULL, factor_rows bytea NOT NULL, factors bytea NOT NULL, sources bytea "
        "NOT NULL, is_complete bigint NOT NULL, planning_states bigint, tool text NOT NULL, "
        "settings text NOT NULL, seed bigint NOT NULL, time text NOT NULL, checksum bigint NOT "
        "NULL, PRIMARY KEY (id, cell))"),
};

Result<void> create(PostgresConnection& connection, std::span<const std::string_view> tables,
                    bool is_temporary) {
  for (const std::string_view table : tables) {
    const bool is_temporary_table = is_temporary && table.starts_with("TABLE");
    MNEME_TRY(connection.query(
        fmt::format("CREATE {}{}", is_temporary_table ? "TEMPORARY " : "", table)));
  }
  return {};
}

std::vector<std::string> parameters_of(const RobotSignature& robot) {
  return {robot.robot_name, robot.kinematics_hash, robot.model_hash,
          std::to_string(robot.joint_count), std::to_string(checksum_of(robot))};
}

Result<void> insert_robot(PostgresConnection& connection, const RobotSignature& robot) {
  return connection.run(
      fmt::format("INSERT INTO mneme_robot VALUES (1, {}, $1, $2, $3, $4::integer, "
                  "$5::bigint)",
                  kSchemaVersion),
      parameters_of(robot));
}

Result<void> create_all(PostgresConnection& connection, const RobotSignature& robot) {
  MNEME_TRY(create(connection, kNewTables, false));
  MNEME_TRY(create(connection,
                   std::array{kHeadTable, kTombstoneTable, kTombstoneIndex, kLessonTable}, false));
  MNEME_TRY(insert_robot(connection, robot));
  return write_postgres_head(connection, StoreState{});
}

/// SQLSTATEs when two processes create the same tables at once.
bool was_faster(const std::string& state) {
  return state == "42P07" || state == "23505" || state == "42710";
}

tl::unexpected<Error> damaged(const PostgresConnection& connection, const char* what) {
  return fail(ErrorCode::corrupt, "{}: {}", connection.name(), what);
}

/// The only row of a table.
Result<PostgresAnswer> only_row(PostgresConnection& connection, const std::string& sql,
                                const char* name) {
  auto answer = MNEME_TRY(connection.query(sql));
  if (answer.row_count() == 1) return answer;
  return fail(ErrorCode::corrupt, "{}: {} is missing", connection.name(), name);
}

constexpr const char* kRobotRow = "the row that names the robot";
constexpr const char* kHeadRow = "the tally of rows";

}  // namespace

Result<int> read_postgres_version(PostgresConnection& connection) {
  const auto exists = MNEME_TRY(connection.query(
      "SELECT to_regclass('mneme_robot') IS NOT NULL, to_regclass('mneme_space') IS NOT NULL"));
  const bool is_new = exists.integer(0, 0) != 0;
  if (!is_new && exists.integer(0, 1) == 0) return 0;
  const auto row = MNEME_TRY(
      only_row(connection,
               fmt::format("SELECT schema_version FROM {}", is_new ? "mneme_robot" : "mneme_space"),
               kRobotRow));
  const std::int64_t version = row.integer(0, 0);
  if (version < 1) return damaged(connection, "its schema version was never in use");
  if (version == (is_new ? kSchemaVersion : kOldSchema)) return static_cast<int>(version);
  return refuse_schema(connection.name(), version);
}

Result<RobotSignature> read_postgres_signature(PostgresConnection& connection) {
  const auto row = MNEME_TRY(
      only_row(connection, fmt::format("SELECT {} FROM mneme_robot", kRobotColumns), kRobotRow));
  const auto robot = parse_robot(PostgresRow(row));
  if (!robot) return damaged(connection, "the row that names the robot is damaged");
  return *robot;
}

Result<void> create_postgres_schema(PostgresConnection& connection, const RobotSignature& robot) {
  MNEME_TRY(connection.query("BEGIN"));
  const auto created = create_all(connection, robot);
  const std::string state = connection.last_state();
  const auto ended = connection.run(created ? "COMMIT" : "ROLLBACK");
  if (!created) return was_faster(state) ? Result<void>() : created;
  return ended;
}

Result<bool> has_postgres_lessons(PostgresConnection& connection) {
  return connection.query("SELECT to_regclass('mneme_lesson') IS NOT NULL")
      .map([](const PostgresAnswer& answer) { return answer.integer(0, 0) != 0; });
}

Result<void> create_postgres_lessons(PostgresConnection& connection) {
  const bool exists = MNEME_TRY(has_postgres_lessons(connection));
  return exists ? Result<void>() : create(connection, std::array{kLessonTable}, false);
}

Result<void> replace_postgres_signature(PostgresConnection& connection,
                                        const RobotSignature& robot) {
  return connection.run(
      "UPDATE mneme_robot SET robot_name = $1, kinematics_hash = $2, model_hash = $3, "
      "joint_count = $4::integer, checksum = $5::bigint",
      parameters_of(robot));
}

Result<StoreState> read_postgres_head(PostgresConnection& connection, bool is_locked) {
  const auto row = MNEME_TRY(only_row(
      connection,
      fmt::format("SELECT {} FROM mneme_head{}", kHeadColumns, is_locked ? " FOR UPDATE" : ""),
      kHeadRow));
  const auto head = parse_head(PostgresRow(row));
  if (!head) return damaged(connection, "the tally of rows is damaged");
  return *head;
}

Result<void> write_postgres_head(PostgresConnection& connection, const StoreState& state) {
  const auto numbers = to_numbers(state);
  std::vector<std::string> parameters;
  for (const std::int64_t number : numbers) parameters.push_back(std::to_string(number));
  parameters.push_back(std::to_string(hash_numbers(numbers)));
  return connection.run(
      "INSERT INTO mneme_head VALUES (1, $1::bigint, $2::bigint, $3::bigint, $4::bigint, "
      "$5::bigint, $6::bigint, $7::bigint, $8::bigint, $9::bigint) ON CONFLICT (id) DO UPDATE "
      "SET generation = excluded.generation, epoch = excluded.epoch, last_row = "
      "excluded.last_row, last_tombstone = excluded.last_tombstone, row_count = "
      "excluded.row_count, row_digest = excluded.row_digest, tombstone_count = "
      "excluded.tombstone_count, tombstone_digest = excluded.tombstone_digest, checksum = "
      "excluded.checksum",
      parameters);
}

namespace {

Result<void> put_old_tables_aside(PostgresConnection& connection) {
  return connection.run_all({"DROP INDEX mneme_experience_content",
                             "DROP INDEX mneme_experience_kind", "DROP TABLE mneme_space",
                             "ALTER TABLE mneme_experience RENAME TO mneme_old_experience",
                             "ALTER TABLE mneme_mixture RENAME TO mneme_old_mixture"});
}

/// Temporary tables hide permanent ones of the same name, so the views are created first.
Result<void> hide_old_tables(PostgresConnection& connection) {
  for (const char* table : {"experience", "mixture", "head", "tombstone"}) {
    MNEME_TRY(connection.query(
        fmt::format("CREATE TEMPORARY VIEW mneme_old_{0} AS TABLE mneme_{0}", table)));
  }
  MNEME_TRY(create(connection, std::array{kHeadTable, kTombstoneTable}, true));
  return connection.run_all({"INSERT INTO mneme_head TABLE mneme_old_head",
                             "INSERT INTO mneme_tombstone TABLE mneme_old_tombstone"});
}

/// In batches, because the visitor uses the same connection.
Result<void> read_old_rows(PostgresConnection& connection,
                           const std::function<Result<void>(std::span<const StoredRow>)>& visit) {
  constexpr int kRowsAtOnce = 500;
  std::int64_t last = 0;
  for (;;) {
    const auto answer = MNEME_TRY(connection.query(
        fmt::format("SELECT {} FROM mneme_old_experience e LEFT JOIN mneme_old_mixture m ON m.id = "
                    "e.id AND m.cell = e.cell WHERE e.id > $1::bigint ORDER BY e.id LIMIT {}",
                    kOldColumns, kRowsAtOnce),
        {std::to_string(last)}));
    std::vector<StoredRow> rows;
    for (int i = 0; i < answer.row_count(); ++i) {
      rows.push_back(read_row(PostgresRow(answer, i), RowParts::all));
    }
    if (rows.empty()) return {};
    last = rows.back().id;
    MNEME_TRY(visit(rows));
  }
}

}  // namespace

Result<void> migrate_tables(PostgresConnection& connection, OpenMode mode,
                            const std::function<Result<void>(const OldRows&)>& write_rows) {
  const auto row = MNEME_TRY(
      only_row(connection, "SELECT robot_name, robot_hash, joint_count, checksum FROM mneme_space",
               kRobotRow));
  const PostgresRow old(row);
  const RobotSignature robot =
      MNEME_TRY(upgraded_robot(connection.name(), old.text(0), old.text(1),
                               static_cast<int>(old.integer(2)), old.integer(3)));
  const bool is_reader = mode == OpenMode::read_only;
  MNEME_TRY(is_reader ? hide_old_tables(connection) : put_old_tables_aside(connection));
  MNEME_TRY(create(connection, kNewTables, is_reader));
  MNEME_TRY(write_rows([&](const auto& visit) { return read_old_rows(connection, visit); }));
  MNEME_TRY(insert_robot(connection, robot));
  // Remaining views would keep another process from dropping the tables.
  return connection.run_all({is_reader ? "DROP VIEW mneme_old_experience, mneme_old_mixture, "
                                         "mneme_old_head, mneme_old_tombstone"
                                       : "DROP TABLE mneme_old_experience, mneme_old_mixture"});
}

}  // namespace mneme::internal
