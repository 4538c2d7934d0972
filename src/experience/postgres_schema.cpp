// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/postgres_schema.h"

#include "experience/schema.h"

#include <fmt/format.h>

#include <array>

namespace mneme::internal {
namespace {

// Primary keys hold the cell, so that a cluster may spread the two large tables by it.
constexpr std::array kTables = {
    "CREATE TABLE mneme_space (id integer PRIMARY KEY CHECK (id = 1), schema_version integer NOT "
    "NULL, robot_name text NOT NULL, robot_hash text NOT NULL, joint_count integer NOT NULL, "
    "checksum bigint NOT NULL)",
    "CREATE TABLE mneme_head (id integer PRIMARY KEY CHECK (id = 1), generation bigint NOT NULL, "
    "epoch bigint NOT NULL, last_row bigint NOT NULL, last_tombstone bigint NOT NULL, row_count "
    "bigint NOT NULL, row_digest bigint NOT NULL, tombstone_count bigint NOT NULL, "
    "tombstone_digest bigint NOT NULL, checksum bigint NOT NULL)",
    "CREATE TABLE mneme_experience (id bigint NOT NULL, generation bigint NOT NULL, cell bigint "
    "NOT NULL, kind text NOT NULL, content bytea NOT NULL, components bigint NOT NULL, key bytea "
    "NOT NULL, checksum "
    "bigint NOT NULL, PRIMARY KEY (id, cell))",
    "CREATE INDEX mneme_experience_content ON mneme_experience (content)",
    "CREATE INDEX mneme_experience_kind ON mneme_experience (kind, id)",
    "CREATE TABLE mneme_mixture (id bigint NOT NULL, cell bigint NOT NULL, means bytea NOT NULL, "
    "factor_rows bytea NOT NULL, factors bytea NOT NULL, origins bytea NOT NULL, tool text NOT "
    "NULL, settings text NOT NULL, seed bigint NOT NULL, time text NOT NULL, checksum bigint NOT "
    "NULL, PRIMARY KEY (id, cell))",
    "CREATE TABLE mneme_tombstone (id bigint PRIMARY KEY, row_id bigint NOT NULL, generation "
    "bigint NOT NULL, reason text NOT NULL, time text NOT NULL, checksum bigint NOT NULL)",
    "CREATE INDEX mneme_tombstone_row ON mneme_tombstone (row_id)",
};

Result<void> create_all(PostgresConnection& connection, const ExperienceSpace& space) {
  for (const char* sql : kTables) {
    const auto created = connection.query(sql);
    if (!created) return tl::unexpected(created.error());
  }
  const auto inserted = connection.query(
      "INSERT INTO mneme_space VALUES (1, $1::integer, $2, $3, $4::integer, $5::bigint)",
      {std::to_string(kSchemaVersion), space.robot_name, space.robot_hash,
       std::to_string(space.joint_count), std::to_string(checksum_of(space))});
  if (!inserted) return tl::unexpected(inserted.error());
  return write_postgres_head(connection, StoreState{});
}

/// Two processes that create the same tables collide in one of these ways.
bool was_faster(const std::string& state) {
  return state == "42P07" || state == "23505" || state == "42710";
}

tl::unexpected<Error> damaged(const PostgresConnection& connection, const char* what) {
  return fail(ErrorCode::corrupt, fmt::format("{}: {}", connection.name(), what));
}

}  // namespace

Result<int> read_postgres_version(PostgresConnection& connection) {
  const auto exists = connection.query("SELECT to_regclass('mneme_space') IS NOT NULL");
  if (!exists) return tl::unexpected(exists.error());
  if (exists->integer(0, 0) == 0) return 0;
  const auto version = connection.query("SELECT schema_version FROM mneme_space");
  if (!version) return tl::unexpected(version.error());
  if (version->row_count() == 0) {
    return damaged(connection, "the row that names the robot is missing");
  }
  const std::int64_t number = version->integer(0, 0);
  if (number < 1) return damaged(connection, "its schema version was never in use");
  if (number != kSchemaVersion) return refuse_schema(connection.name(), number);
  return static_cast<int>(number);
}

Result<ExperienceSpace> read_postgres_space(PostgresConnection& connection) {
  const auto row =
      connection.query("SELECT robot_name, robot_hash, joint_count, checksum FROM mneme_space");
  if (!row) return tl::unexpected(row.error());
  if (row->row_count() == 0) {
    return damaged(connection, "the row that names the robot is missing");
  }
  ExperienceSpace space;
  space.robot_name = row->text(0, 0);
  space.robot_hash = row->text(0, 1);
  space.joint_count = static_cast<int>(row->integer(0, 2));
  if (row->integer(0, 3) != checksum_of(space) || space.joint_count < 1) {
    return damaged(connection, "the row that names the robot is damaged");
  }
  return space;
}

Result<void> create_postgres_schema(PostgresConnection& connection, const ExperienceSpace& space) {
  const auto begun = connection.query("BEGIN");
  if (!begun) return tl::unexpected(begun.error());
  const auto created = create_all(connection, space);
  const std::string state = connection.last_state();
  const auto ended = connection.query(created ? "COMMIT" : "ROLLBACK");
  if (!created) return was_faster(state) ? Result<void>() : created;
  if (!ended) return tl::unexpected(ended.error());
  return {};
}

Result<StoreState> read_postgres_head(PostgresConnection& connection, bool is_locked) {
  constexpr const char* kSelect =
      "SELECT generation, epoch, last_row, last_tombstone, row_count, row_digest, "
      "tombstone_count, tombstone_digest, checksum FROM mneme_head";
  constexpr const char* kSelectLocked =
      "SELECT generation, epoch, last_row, last_tombstone, row_count, row_digest, "
      "tombstone_count, tombstone_digest, checksum FROM mneme_head FOR UPDATE";
  const auto row = connection.query(is_locked ? kSelectLocked : kSelect);
  if (!row) return tl::unexpected(row.error());
  if (row->row_count() != 1) return damaged(connection, "the tally of rows is missing");
  std::array<std::int64_t, kHeadSize> numbers{};
  for (int i = 0; i < kHeadSize; ++i) numbers[static_cast<std::size_t>(i)] = row->integer(0, i);
  if (row->integer(0, kHeadSize) != hash_numbers(numbers)) {
    return damaged(connection, "the tally of rows is damaged");
  }
  return to_state(numbers);
}

Result<void> write_postgres_head(PostgresConnection& connection, const StoreState& state) {
  const auto numbers = to_numbers(state);
  std::vector<std::string> parameters;
  for (const std::int64_t number : numbers) parameters.push_back(std::to_string(number));
  parameters.push_back(std::to_string(hash_numbers(numbers)));
  const auto written = connection.query(
      "INSERT INTO mneme_head VALUES (1, $1::bigint, $2::bigint, $3::bigint, $4::bigint, "
      "$5::bigint, $6::bigint, $7::bigint, $8::bigint, $9::bigint) ON CONFLICT (id) DO UPDATE SET "
      "generation = excluded.generation, epoch = excluded.epoch, last_row = excluded.last_row, "
      "last_tombstone = excluded.last_tombstone, row_count = excluded.row_count, row_digest = "
      "excluded.row_digest, tombstone_count = excluded.tombstone_count, tombstone_digest = "
      "excluded.tombstone_digest, checksum = excluded.checksum",
      parameters);
  if (!written) return tl::unexpected(written.error());
  return {};
}

}  // namespace mneme::internal
